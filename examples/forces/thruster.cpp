// A rocket whose fuel is a property of one's own, and whose mass falls as it burns: Tsiolkovsky's equation,
// then free flight.
#include "pcphys/write_kernel.h"
#include "show.h"

using namespace pcphys;
using show::must;

PCPHYS_KERNEL(thruster,
              (PC_IN(Quaternion) orientation, PC_IN(Real) mass, PC_INOUT(Real) fuel, PC_INOUT(Vec3) force,
               PC_PARAM(Real) tank, PC_PARAM(Real) exhaust_speed, PC_PARAM(Real) flow, PC_PARAM(Real) h),
              {
                Real wanted = flow * h;
                Real burned = pc_min(fuel, wanted);
                Real thrust = pc_div(burned, h) * exhaust_speed;
                Real spent = tank - fuel;
                Real share = pc_div(mass, mass - spent);
                Vec3 up = pc_rotate(orientation, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)));
                fuel = fuel - burned;
                force = pc_madd(force, up, thrust * share);
              })

int main(int argc, char** argv) {
  constexpr double gravity = 9.81, full = 100, tank = 40, exhaust_speed = 1000, flow = 5;  // m/s^2, kg, kg, m/s, kg/s
  show::Csv csv(argc, argv, "time,speed,speed exact,fuel,fuel exact");
  double burning_error = 0, cut_off_error = 0;
  const bool same = show::same_on_both_places([&](Place place) {
    World world;
    const auto fuel = must(world.add_property<Real>("fuel", tank, "kg"));
    BodyDef rocket;
    rocket.shapes = {ShapeDef::capsule(0.25, 1)};
    rocket.mass = full;
    const BodyId body = must(world.create_body(rocket));
    Stepper stepper(show::at(place));
    must(stepper.add_kernel(world, {.text = thruster::text(),
                                    .parameters = {{"tank", tank}, {"exhaust_speed", exhaust_speed}, {"flow", flow}}}));
    show::run(world, stepper, 12, [&](double t) {
      const double burning = std::min(t, tank / flow), left = full - flow * burning, log = std::log(full / left);
      const double speed = exhaust_speed * log - gravity * t;
      double& error = t < tank / flow ? burning_error : cut_off_error;
      error = std::max(error, std::fabs(must(world.velocity(body)).y - speed));
      csv.row(place, {t, must(world.velocity(body)).y, speed, must(world.get(fuel, body)), tank - flow * burning});
    });
    return world.hash();
  });
  // what stops at once is felt half a sub-step early: velocities stand half a sub-step behind
  const double jump = exhaust_speed * flow / (full - tank) / 60 / 4 / 2;
  std::printf(
      "thruster: error of the speed %.2f mm/s while it burns, %.1f mm/s after the jump at its end (%.1f foreseen)\n",
      1000 * burning_error, 1000 * cut_off_error, 1000 * jump);
  return same && burning_error < 2e-3 && std::fabs(cut_off_error - jump) < 5e-3 ? 0 : 1;
}
