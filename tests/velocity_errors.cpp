// Pins: velocities that no body has, and what would make one beyond the range of numbers, are refused, and the world is
// as it was.
#include "support_world.h"

using namespace worldtest;

TEST_CASE("a fixed body has no velocity but zero, whoever asks") {
  World world;
  BodyDef def = fixed_box({}, {1, 1, 1});
  def.velocity = {0, 2, 0};
  CHECK_REFUSED(world, world.create_body(def), ErrorCode::bad_argument,
                "A fixed body has no velocity; make it kinematic to move it.");
  def.velocity = {};
  def.angular_velocity = {0, 0, -1};
  CHECK_REFUSED(world, world.create_body(def), ErrorCode::bad_argument,
                "A fixed body has no angular velocity; make it kinematic to move it.");
  def.angular_velocity = {};
  const BodyId fixed = must(world.create_body(def));
  const std::uint64_t hash = world.hash();
  for (const BodyId body : {fixed, world.ground()}) {
    must(world.set_velocity(body, {}));
    must(world.set_angular_velocity(body, {}));
    CHECK_REFUSED(world, world.set_velocity(body, {1, 0, 0}), ErrorCode::bad_argument, "A fixed body has no velocity");
    CHECK_REFUSED(world, world.set_angular_velocity(body, {1, 0, 0}), ErrorCode::bad_argument,
                  "A fixed body has no angular");
  }
  CHECK(world.hash() == hash);
}

TEST_CASE("last positions need a step") {
  World world;
  const BodyId body = must(world.create_body(ball({})));
  const char* words = "Last positions are one sub-step ago, and no step has been made yet; set a velocity instead.";
  CHECK_REFUSED(world, world.position_last(body), ErrorCode::bad_time_step, words);
  CHECK_REFUSED(world, world.set_position_last(body, {}), ErrorCode::bad_time_step, words);
  CHECK_REFUSED(world, world.orientation_last(body), ErrorCode::bad_time_step, words);
  CHECK_REFUSED(world, world.set_orientation_last(body, {}), ErrorCode::bad_time_step, words);
}

TEST_CASE("what a velocity or an angular momentum beyond the range of numbers would be made of is refused") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World w(WorldDef{precision});
    BodyDef def = ball({});
    def.mass = 1e30;
    def.moments = Vec3{1e30, 1e20, 1e30};
    const BodyId heavy = must(w.create_body(def));
    CHECK_REFUSED(w, w.set_angular_velocity(heavy, {0, 0, 1e15}), ErrorCode::not_finite,
                  "The angular momentum of a body would be");
    must(w.set_angular_velocity(heavy, {0, 0, 9e5}));
    CHECK_REFUSED(w, w.set_angular_velocity(heavy, {0, 1e15, 0}), ErrorCode::not_finite, "up to 1e+45 kg m^2/s");
    def.angular_velocity = {1e15, 0, 0};
    CHECK_REFUSED(w, w.create_body(def), ErrorCode::not_finite, "The angular momentum of a body would be");
    const BodyId light = must(w.create_body(ball({5, 0, 0})));
    must(w.set_angular_velocity(light, {0, 1e15, 0}));
    CHECK_REFUSED(w, w.set_mass_properties(light, {1e30, {1e30, 1e30, 1e30}}), ErrorCode::not_finite,
                  "The angular momentum");
    Stepper stepper;
    run(w, stepper, 1, 1e-15);
    const Vec3 at = must(w.pose(light)).position;
    CHECK_REFUSED(w, w.set_position_last(light, at + Vec3{1, 0, 0}), ErrorCode::not_finite,
                  "The velocity that a body's last position");
    CHECK_REFUSED(w, w.set_orientation_last(light, {1, 0, 0, 0}), ErrorCode::not_finite,
                  "The angular velocity that a body's last orientation");
  }
}

TEST_CASE("forces far beyond what a body can follow, and gravity, leave its velocity as it reads") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World w(WorldDef{precision});
    BodyDef def = ball({});
    def.mass = 1e-28;
    def.linear_drag = def.angular_drag = 1e6;
    def.velocity = {1, 2, 3};
    const BodyId body = must(w.create_body(def));
    Stepper stepper;
    run(w, stepper, 1);
    const Vec3 velocity = must(w.velocity(body));
    REQUIRE(finite(velocity));
    for (int i = 0; i < 5; i++) (void)must(w.add_force(body, Wrench{{1e15, 0, 0}, {0, 1e15, 0}}));
    CHECK(length(must(w.velocity(body)) - velocity) <= 1e-6 * length(velocity));
    run(w, stepper, 1);
    must(w.set_gravity({0, 1e15, 0}));
    CHECK(finite(must(w.velocity(body))));
    CHECK(finite(must(w.angular_velocity(body))));
  }
}
