// Two magnets that are let go and fall towards each other: the kernel of examples/magnets.cpp beside the closed form.
#include "../magnet.h"
#include "show.h"

using namespace pcphys;
using show::must;

namespace {

constexpr double mass = 0.1, poles = 9, strength = 2e-3, start = 0.6;  // [kg], [A^2 m^2], [N/A^2], [m]
constexpr double pull = 2 * poles * strength / mass;                   // of their distance r: r'' = -pull / r^2

/// When they have come to a distance; it falls from `start` to 0.
double time_at(double r) {
  const double x = r / start;
  return std::sqrt(start * start * start / (2 * pull)) * (std::sqrt(x * (1 - x)) + std::acos(std::sqrt(x)));
}
double distance_at(double t) {
  double near = 0, far = start;
  for (int i = 0; i < 60; i++) (time_at(0.5 * (near + far)) < t ? far : near) = 0.5 * (near + far);
  return 0.5 * (near + far);
}
double potential(double r) { return -poles * strength / r; }

}  // namespace

int main(int argc, char** argv) {
  show::Csv csv(argc, argv,
                "time,distance,distance exact,kinetic,kinetic exact,potential,potential exact,sum,sum exact");
  double worst = 0, drift = 0;
  const bool same = show::same_on_both_places([&](Place place) {
    World world(WorldDef{.gravity = {}});
    const auto pole = must(world.add_property<Real>("pole", 3, "A m", body_table, Role::input));
    BodyId magnets[2];
    for (int i = 0; i < 2; i++) {
      BodyDef def;
      def.shapes = {ShapeDef::sphere(0.05)};
      def.mass = mass;
      def.pose.position = {(i - 0.5) * start, 0, 0};
      magnets[i] = must(world.create_body(def));
      must(world.set(pole, magnets[i], Real(3)));
    }
    Stepper stepper(show::at(place));
    must(stepper.add_kernel(world,
                            {.text = magnet::text(), .parameters = {{"strength", strength}, {"softening", 0.0}}}));
    show::run(world, stepper, 0.8, [&](double t) {  // they touch after 0.83 s
      const double r = must(world.pose(magnets[1])).position.x - must(world.pose(magnets[0])).position.x;
      const double kinetic = world.kinetic_energy(), exact = distance_at(t), whole = potential(start);
      worst = std::max(worst, std::fabs(r - exact));
      drift = std::max(drift, std::fabs((kinetic + potential(r) - whole) / potential(r)));
      csv.row(place, {t, r, exact, kinetic, whole - potential(exact), potential(r), potential(exact),
                      kinetic + potential(r), whole});
    });
    return world.hash();
  });
  std::printf(
      "attraction: largest error of the distance %.3f mm of 600; energy off by %.3f %% of what is in the field\n",
      1000 * worst, 100 * drift);
  return same && worst < 1e-3 && drift < 0.01 ? 0 : 1;
}
