// Wind with drag by cross-section: three equal planks, flat, tilted and on edge, in a wind from below. One rises, one
// hovers, one falls.
#include "pcphys/write_kernel.h"
#include "show.h"

using namespace pcphys;
using show::must;

PCPHYS_KERNEL(wind,
              (PC_IN(Vec3) displacement_rate, PC_IN(Quaternion) orientation, PC_IN(Vec3) half_extents, PC_IN(Real) mass,
               PC_INOUT(Vec3) force, PC_PARAM(Vec3) gravity, PC_PARAM(Vec3) wind_velocity, PC_PARAM(Real) half_density,
               PC_PARAM(Real) h),
              {
                Vec3 falls = pc_madd(displacement_rate, gravity, h * PC_REAL(0.5));
                Vec3 air = pc_sub(wind_velocity, falls);
                Vec3 seen = pc_rotate(pc_conjugate(orientation), air);
                Real area_x = half_extents.y * half_extents.z * PC_REAL(4.0);
                Real area_y = half_extents.z * half_extents.x * PC_REAL(4.0);
                Real area_z = half_extents.x * half_extents.y * PC_REAL(4.0);
                Real swept = pc_abs(seen.x) * area_x + pc_abs(seen.y) * area_y + pc_abs(seen.z) * area_z;
                Real flow = swept * half_density;
                force = pc_madd(force, air, pc_div(mass * flow, mass + flow * h));
              })

int main(int argc, char** argv) {
  constexpr double pi = 3.14159265358979, gravity = 9.81;       // -, [m/s^2]
  constexpr double density = 1.2, drag = 1.05, wind_speed = 8;  // of air [kg/m^3], coefficient, [m/s]
  constexpr Vec3 half{0.5, 0.05, 0.25};                         // of a plank [m]
  constexpr double tilts[] = {0, pi / 4, pi / 2};               // about z: the wind sees 0.5, 0.39 and 0.05 m^2
  show::Csv csv(argc, argv, "time,flat,flat exact,tilted,tilted exact,on edge,on edge exact");
  double error = 0;
  const bool same = show::same_on_both_places([&](Place place) {
    World world;
    must(world.add_property<Vec3>("half_extents", half, "m", body_table, Role::input));
    BodyId planks[3];
    for (int i = 0; i < 3; i++) {
      BodyDef plank;
      plank.shapes = {ShapeDef::box(half)};
      plank.density = 30;
      plank.pose = {{2.0 * i, 0, 0}, axis_angle({0, 0, 1}, tilts[i])};
      planks[i] = must(world.create_body(plank));
    }
    const double mass = must(world.mass_properties(planks[0])).mass;
    Stepper stepper(show::at(place));
    must(stepper.add_kernel(
        world, {.text = wind::text(),
                .parameters = {{"wind_velocity", Vec3{0, wind_speed, 0}}, {"half_density", density * drag / 2}}}));
    show::run(world, stepper, 4, [&](double t) {
      double speed[3], exact[3];
      for (int i = 0; i < 3; i++) {
        const double area = 4 * half.z * (half.x * std::cos(tilts[i]) + half.y * std::sin(tilts[i]));
        const double limit = std::sqrt(mass * gravity / (density * drag * area / 2)),
                     grown = std::tanh(gravity * t / limit);
        exact[i] = wind_speed - limit * (wind_speed + limit * grown) / (limit + wind_speed * grown);
        speed[i] = must(world.velocity(planks[i])).y;
        error = std::max(error, std::fabs(speed[i] - exact[i]));
      }
      csv.row(place, {t, speed[0], exact[0], speed[1], exact[1], speed[2], exact[2]});
    });
    return world.hash();
  });
  std::printf("wind: largest error of a speed %.2f mm/s\n", 1000 * error);
  return same && error < 2e-4 ? 0 : 1;
}
