// Pins that a force whose parameter the host changes between two steps jumps there: the old force until then, the new
// one from then on, as where the host changes gravity or a constant force; on every place with the same bits, and
// without a second run of what kernels do besides. Until it was so, the speed was off by half a sub-step times the jump
// of the acceleration.
#include <cmath>

#include "pcphys/write_kernel.h"
#include "support_world.h"

using namespace worldtest;

namespace {

PCPHYS_KERNEL(push,
              (PC_IN(Real) mass, PC_INOUT(Vec3) force, PC_INOUT(Vec3) torque, PC_PARAM(Vec3) acceleration,
               PC_PARAM(Vec3) twist),
              {
                force = pc_madd(force, acceleration, mass);
                torque = pc_add(torque, twist);
              })
PCPHYS_KERNEL(burn,
              (PC_INOUT(Real) fuel, PC_INOUT(Vec3) force, PC_PARAM(Real) flow, PC_PARAM(Real) speed, PC_PARAM(Real) h),
              {
                fuel = fuel - flow * h;
                force.y = force.y + flow * speed;
              })
PCPHYS_KERNEL(pull_home, (PC_IN(Vec3) position, PC_IN(Real) mass, PC_INOUT(Vec3) force, PC_PARAM(Real) stiffness),
              { force = pc_madd(force, position, -stiffness * mass); })

double tolerance(Precision precision) { return precision == Precision::f32 ? 1e-6 : 1e-12; }
KernelDef pushing(bool once_a_step) {
  KernelDef def{.text = push::text(), .parameters = {{"acceleration", Vec3{3, -1, 0}}, {"twist", Vec3{0, 0.02, 0}}}};
  def.once_a_step = once_a_step;
  return def;
}

}  // namespace

TEST_CASE("speed, spin and place after a jump are exact") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const bool once_a_step : {false, true})
      for (const bool resident : {false, true}) {
        require_gl();
        const double frames = 60;
        StepSettings settings;
        if (resident) settings.set_all(Place::gl);
        settings.resident = resident;
        World world(WorldDef{precision, {0, -9.81, 0}});
        const BodyId b = must(world.create_body(ball({})));
        Stepper stepper(settings);
        must(stepper.add_kernel(world, pushing(once_a_step)));
        run(world, stepper, int(frames), 1 / frames);
        const Vec3 turns = must(world.angular_velocity(b));
        must(stepper.set_parameter("push", {"acceleration", Vec3{-5, 20, 2}}));
        must(stepper.set_parameter("push", {"acceleration", Vec3{-5, 40, 2}}));  // the last counts
        must(stepper.set_parameter("push", {"twist", Vec3{0, -0.01, 0}}));
        run(world, stepper, int(frames), 1 / frames);
        const Vec3 v = must(world.velocity(b)), p = must(world.pose(b)).position, w = must(world.angular_velocity(b));
        const double near = tolerance(precision) * 20;  // of 20 m/s and 20 m/s^2
        CHECK(std::abs(v.x + 2) < near);
        CHECK(std::abs(v.y - (-10.81 + 30.19)) < near);
        CHECK(std::abs(v.z - 2) < near);
        CHECK(std::abs(p.x - (1.5 + 3 - 2.5)) < near);
        CHECK(std::abs(p.y - (-10.81 * 1.5 + 30.19 / 2)) < near);
        CHECK(w.y == doctest::Approx(turns.y / 2).epsilon(tolerance(precision) * 10));
      }
}

TEST_CASE("what such a kernel does besides is done once, and all places agree") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    std::uint64_t wanted = 0;
    for (const Mix& mix : mixes()) {
      World world(WorldDef{precision, {0, -9.81, 0}});
      must(world.add_property<Real>("fuel", 2.0, "kg"));
      BodyDef def = ball({0, 5, 0});
      def.mass = 2;
      const BodyId b = must(world.create_body(def));
      must(world.create_body(ball({0, 0.5, 0})));
      must(world.create_body(fixed_box({0, -1, 0}, {5, 1, 5})));
      Stepper stepper(mix.settings());
      must(stepper.add_kernel(world, {.text = burn::text(), .parameters = {{"flow", 0.25}, {"speed", 80.0}}}));
      run(world, stepper, 60);
      must(stepper.set_parameter("burn", {"flow", 0.5}));
      run(world, stepper, 60);
      CHECK(must(world.get(must(world.property<Real>("fuel")), b)) == doctest::Approx(1.25).epsilon(1e-5));
      CHECK(must(world.velocity(b)).y == doctest::Approx(30 - 2 * 9.81).epsilon(tolerance(precision) * 10));
      if (wanted == 0) wanted = world.hash();
      CHECK_MESSAGE(world.hash() == wanted, mix.text());
    }
  }
}

TEST_CASE("a parameter given anew in each step: what it was changes nothing, and a spring gains nothing") {
  std::uint64_t hashes[2];
  for (int again = 0; again < 2; again++) {
    World world(WorldDef{Precision::f64, {}});
    must(world.create_body(ball({1, 0, 0})));
    Stepper stepper;
    must(stepper.add_kernel(world, {.text = pull_home::text(), .parameters = {{"stiffness", 100.0}}}));
    for (int n = 0; n < 100; n++) {
      if (again) must(stepper.set_parameter("pull_home", {"stiffness", 100.0}));
      run(world, stepper, 1);
    }
    hashes[again] = world.hash();
  }
  CHECK(hashes[0] == hashes[1]);

  // Stiffness to and fro: in each half the speed obeys its own energy; the error is of second order.
  double errors[2];
  for (int fine = 0; fine < 2; fine++) {
    World world(WorldDef{Precision::f64, {}});
    const BodyId b = must(world.create_body(ball({1, 0, 0})));
    Stepper stepper;
    must(stepper.add_kernel(world, {.text = pull_home::text(), .parameters = {{"stiffness", 4.0}}}));
    const int steps = fine ? 120 : 60;
    double x = 1, v = 0;
    for (int part = 0; part < 6; part++) {
      const double w = part % 2 ? 3 : 2;
      must(stepper.set_parameter("pull_home", {"stiffness", w * w}));
      run(world, stepper, steps, 1.0 / steps);
      const double x0 = x, v0 = v;
      x = x0 * std::cos(w) + v0 / w * std::sin(w);
      v = v0 * std::cos(w) - x0 * w * std::sin(w);
    }
    errors[fine] = std::abs(must(world.velocity(b)).x - v) + std::abs(must(world.pose(b)).position.x - x);
  }
  MESSAGE("stiffness that jumps five times: " << errors[0] << ", " << errors[1]);
  CHECK(errors[0] < 2e-3);
  CHECK(errors[0] / errors[1] == doctest::Approx(4).epsilon(0.15));
}
