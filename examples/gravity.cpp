// A cluster of stars under its own gravity, and its energy and momentum as totals over all stars,
// made where the stars are.
#include <cmath>
#include <cstdio>

#include "gravitation.h"
#include "pcphys/pcphys.h"

using namespace pcphys;

PCPHYS_KERNEL(totals,
              (PC_IN(Real) mass, PC_IN(Vec3) displacement_rate, PC_IN(Real) potential, PC_SUM(Real) energy,
               PC_SUM(Vec3) momentum),
              {
                precise Real v2 = pc_dot(displacement_rate, displacement_rate);
                precise Real twice = mass * v2;
                precise Real both = twice + potential;  // of each pair a half is a star's
                energy = both * PC_REAL(0.5);
                momentum = pc_scale(displacement_rate, mass);
              })

int main() {
  std::uint64_t hashes[2];
  for (const Place place : {Place::cpu, Place::gl}) {
    World world({.precision = Precision::f64, .gravity = {}});
    (void)world.add_property<Real>("potential", 0, "J");
    const TableId sums = *world.add_table("sums", 1);
    const auto energy = world.add_property<Real>("energy", 0, "J", sums);
    const auto momentum = world.add_property<Vec3>("momentum", {}, "kg m/s", sums);
    BodyDef star;
    star.shapes = {ShapeDef::sphere(0.01)};
    star.shapes[0].filter.mask = 0;  // stars pass each other
    for (int i = 0; i < 200; i++) {
      const double turn = 2.4 * i, from = 0.15 * std::sqrt(i + 1.0);  // a disc that turns
      star.mass = 1 + i % 3;
      star.pose.position = {from * std::cos(turn), 0.1 * std::sin(7.0 * i), from * std::sin(turn)};
      star.velocity = Vec3{-std::sin(turn), 0, std::cos(turn)} * (0.7 * std::sqrt(from));
      if (!world.create_body(star)) return 1;
    }
    StepSettings settings;
    settings.set_all(place);
    Stepper stepper(settings);
    Status ok =
        stepper.add_kernel(world, {.text = gravitation::text(), .parameters = {{"G", 0.005}, {"softening", 0.01}}});
    if (ok) ok = stepper.add_kernel(world, {.text = totals::text()});
    if (!ok) return std::puts(ok.error().message.c_str()), 1;
    double first = 0, last = 0;
    for (int i = 0; i < 120; i++) {
      if (const StepReport& made = stepper.step(world, 1.0 / 120); !made)
        return std::puts(made.error.message.c_str()), 1;
      last = double(*world.get(*energy, RowOf(1)));
      if (i == 0) first = last;
    }
    const double drift = std::abs(last / first - 1);
    std::printf("%s: energy %.6f J, %.1e of it gained or lost; momentum %.3f kg m/s along x; hash %016llx\n",
                name(place), last, drift, world.get(*momentum, RowOf(1))->x, (unsigned long long)world.hash());
    if (!(drift < 0.01)) return 1;
    hashes[int(place)] = world.hash();
  }
  return hashes[0] == hashes[1] ? 0 : 1;
}
