// Buoyancy and drag in water: a sphere and boxes go down as far as Archimedes says,
// and what is too heavy sinks at its terminal speed.
#include "pcphys/write_kernel.h"
#include "show.h"

using namespace pcphys;
using show::must;

PCPHYS_KERNEL(float_sphere,
              (PC_IN(Vec3) position, PC_IN(Real) radius, PC_OUT(Real) wet, PC_INOUT(Vec3) force, PC_PARAM(Vec3) gravity,
               PC_PARAM(Real) density),
              {
                Real depth = pc_clamp(radius - position.y, PC_REAL(0.0), radius * PC_REAL(2.0));
                Real beside = radius * PC_REAL(3.0) - depth;
                Real volume = depth * depth * beside * PC_REAL(1.0471975511965976);
                Real whole = radius * radius * radius * PC_REAL(4.1887902047863905);
                wet = volume * pc_inverse_or_zero(whole);
                force = pc_madd(force, gravity, -density * volume);
              })

PCPHYS_KERNEL(float_box,
              (PC_IN(Vec3) position, PC_IN(Quaternion) orientation, PC_IN(Vec3) half_extents, PC_INOUT(Real) wet,
               PC_INOUT(Vec3) force, PC_INOUT(Vec3) torque, PC_PARAM(Vec3) gravity, PC_PARAM(Real) density),
              {
                Vec3 quarter = pc_scale(half_extents, PC_REAL(0.5));
                Vec3 up = pc_rotate(pc_conjugate(orientation), Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)));
                Real reach = pc_abs(up.x) * quarter.x + pc_abs(up.y) * quarter.y + pc_abs(up.z) * quarter.z;
                Real per_height = pc_inverse_or_zero(reach * PC_REAL(2.0));
                Real cells = PC_REAL(0.0);
                Vec3 arms = pc_zero3();
                for (uint i = 0u; i < 8u; i++) {
                  Real x = (i & 1u) == 0u ? -quarter.x : quarter.x;
                  Real y = (i & 2u) == 0u ? -quarter.y : quarter.y;
                  Real z = (i & 4u) == 0u ? -quarter.z : quarter.z;
                  Vec3 arm = pc_rotate(orientation, Vec3(x, y, z));
                  Real under = reach - position.y - arm.y;
                  Real share = pc_clamp(under * per_height, PC_REAL(0.0), PC_REAL(1.0));
                  cells = cells + share;
                  arms = pc_madd(arms, arm, share);
                }
                Vec3 lift = pc_scale(gravity, -density * half_extents.x * half_extents.y * half_extents.z);
                wet = wet + cells * PC_REAL(0.125);
                force = pc_madd(force, lift, cells);
                torque = pc_add(torque, pc_cross(arms, lift));
              })

PCPHYS_KERNEL(water_drag,
              (PC_IN(Vec3) displacement_rate, PC_IN(Vec3) angular_momentum, PC_IN(Real) mass, PC_IN(Real) wet,
               PC_INOUT(Vec3) force, PC_INOUT(Vec3) torque, PC_PARAM(Vec3) gravity, PC_PARAM(Real) rate,
               PC_PARAM(Real) h),
              {
                Real slow = rate * wet;
                Real half_h = h * PC_REAL(0.5);
                Real kept = pc_div(slow, PC_REAL(1.0) + slow * half_h);
                Vec3 momentum = pc_madd(pc_scale(displacement_rate, mass), pc_madd(force, gravity, mass), half_h);
                Vec3 spin = pc_madd(angular_momentum, torque, half_h);
                force = pc_madd(force, momentum, -kept);
                torque = pc_madd(torque, spin, -kept);
              })

int main(int argc, char** argv) {
  constexpr double pi = 3.14159265358979, water = 1000, gravity = 9.81;  // -, [kg/m^3], [m/s^2]
  constexpr double drag = 4, radius = 0.4;                               // [1/s] under water, of the spheres [m]
  constexpr Vec3 half{0.6, 0.2, 0.4};                                    // of the boxes [m]
  constexpr double densities[] = {300, 400, 750, 1500};                  // sphere, box, tilted box, sphere that sinks
  const auto share = [&](int i) { return densities[i] / water; };        // of the volume that is under water
  const double angle = (std::acos(2 * share(0) - 1) + 4 * pi) / 3;       // of the cubic d^2 (3 r - d) = 4 r^3 share
  const double rest[] = {2 * radius * std::cos(angle), half.y * (1 - 2 * share(1)), half.y * (1 - 2 * share(2))};
  const double sinking = (1 - 1 / share(3)) * gravity / drag;
  show::Csv csv(argc, argv,
                "time,sphere 300,sphere 300 exact,box 400,box 400 exact,tilted box 750,tilted box 750 exact");
  double error = 0, speed_error = 0, tilt = 0;
  const bool same = show::same_on_both_places([&](Place place) {
    World world;
    const auto radii = must(world.add_property<Real>("radius", 0.0, "m", body_table, Role::input));
    const auto extents = must(world.add_property<Vec3>("half_extents", {}, "m", body_table, Role::input));
    must(world.add_property<Real>("wet", 0.0, "1", body_table, Role::scratch));
    BodyId bodies[4];
    for (int i = 0; i < 4; i++) {
      const bool box = i == 1 || i == 2;
      BodyDef def;
      def.shapes = {box ? ShapeDef::box(half) : ShapeDef::sphere(radius)};
      def.density = densities[i];
      def.pose = {{3.0 * i, i == 3 ? -1.0 : 0.5, 0}, axis_angle({0, 0, 1}, i == 2 ? 0.5 : 0)};
      bodies[i] = must(world.create_body(def));
      box ? must(world.set(extents, bodies[i], half)) : must(world.set(radii, bodies[i], Real(radius)));
    }
    Stepper stepper(show::at(place));
    must(stepper.add_kernel(world, {.text = float_sphere::text(), .parameters = {{"density", water}}}));
    must(stepper.add_kernel(world, {.text = float_box::text(), .parameters = {{"density", water}}}));
    must(stepper.add_kernel(world, {.text = water_drag::text(), .parameters = {{"rate", drag}}}));
    const auto height = [&](int i) { return must(world.pose(bodies[i])).position.y; };
    show::run(world, stepper, 15, [&](double t) {
      tilt = 2 * std::asin(std::fabs(must(world.pose(bodies[2])).orientation.z));
      csv.row(place, {t, height(0), rest[0], height(1), rest[1], height(2), rest[2]});
    });
    for (int i = 0; i < 3; i++) error = std::max(error, std::fabs(height(i) - rest[i]));
    speed_error = std::max(speed_error, std::fabs(must(world.velocity(bodies[3])).y + sinking));
    return world.hash();
  });
  std::printf("buoyancy: after 15 s heights are off by up to %.4f mm, the tilt is %.4f rad\n", 1000 * error, tilt);
  std::printf("and the speed of what sinks is off by %.4f mm/s\n", 1000 * speed_error);
  return same && error < 1e-3 && speed_error < 1e-3 && tilt < 1e-2 ? 0 : 1;
}
