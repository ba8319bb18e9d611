// Pins that what a stepper remembers of joints that slept changes nothing: after a waking the next steps have the bits
// of a new stepper.
#include "support_world.h"

using namespace worldtest;

namespace {

/// Two pinned capsules and two boxes side by side on a floor fall asleep and are woken; then a new stepper goes on
/// where `forgets`.
std::uint64_t hash_after_waking(std::uint32_t lanes, bool forgets) {
  World world({.precision = Precision::f32});
  (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
  const auto capsule = [&](double x) {
    BodyDef def;
    def.shapes = {ShapeDef::capsule(0.1, 0.2)};
    def.pose = {{x, 0.1, 0}, axis_angle({0, 0, 1}, 1.5707963267948966)};
    return must(world.create_body(def));
  };
  JointDef pin;
  pin.a = capsule(-0.3);
  pin.b = capsule(0.3);
  pin.frame_a.position = {0, -0.3, 0};
  pin.frame_b.position = {0, 0.3, 0};
  (void)must(world.create_joint(pin));
  StepSettings settings;
  settings.sleep = true;
  settings.lanes = lanes;
  Stepper stepper(settings);
  run(world, stepper, 120);
  REQUIRE(*world.is_asleep(pin.a));
  (void)must(world.create_body(ball({100, 5, 0})));
  run(world, stepper, 2);
  must(world.wake(pin.a));
  must(world.set_velocity(pin.b, {0, 0, 1}));
  if (forgets) {
    Stepper fresh(settings);
    run(world, fresh, 10);
  } else {
    run(world, stepper, 10);
  }
  return world.hash();
}

}  // namespace

TEST_CASE("sleep: joints that wake are solved as a new stepper solves them") {
  for (const std::uint32_t lanes : {1u, 4u, 8u}) {
    CAPTURE(lanes);
    CHECK(hash_after_waking(lanes, false) == hash_after_waking(lanes, true));
  }
}
