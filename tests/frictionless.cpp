// Where nothing that touches has friction, its part of the rows is neither stored nor solved; where no body rotates, no
// rotation is
#include <cmath>
#include <string>

#include "support_world.h"

using namespace worldtest;

namespace {

/// Balls and boxes that fall into a heap on a floor, with a restitution for every third; in the second world one more
/// ball rolls on a rough slab far away, so that whole rows are used for all.
World heap(Precision precision, bool something_rough, double e) {
  World world({precision, {0, -9.81, 0}});
  Material smooth;
  smooth.static_friction = smooth.kinetic_friction = 0;
  BodyDef floor = fixed_box({0, -1, 0}, {20, 1, 20});
  floor.material = smooth;
  must(world.create_body(floor));
  for (int i = 0; i < 24; i++) {
    BodyDef def = ball({0.4 * (i % 3) + 0.01 * i, 0.6 + 0.9 * (i / 3), 0.3 * (i % 2)}, 0.4);
    if (i % 2 == 1) def.shapes = {ShapeDef::box({0.3, 0.4, 0.5})};
    def.material = smooth;
    def.material.restitution = i % 3 == 0 ? e : 0;
    def.angular_velocity = {0.3 * i, -0.2, 0.1 * i};
    must(world.create_body(def));
  }
  if (something_rough) {
    must(world.create_body(fixed_box({100, -1, 0}, {5, 1, 5})));
    BodyDef def = ball({100, 0.49, 0});
    def.velocity = {1, 0, 0};
    must(world.create_body(def));
  }
  return world;
}

}  // namespace

TEST_CASE("a frictionless world solves no rows of friction, with the bits of whole rows") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const double e : {0.0, 0.6}) {
      World smooth = heap(precision, false, e), mixed = heap(precision, true, e);
      Stepper a, b;
      std::vector<BodyId> bodies = smooth.bodies();
      for (int i = 0; i < 120; i++) {
        run(smooth, a, 1);
        run(mixed, b, 1);
        if (smooth.contact_count() == 0) continue;
        CHECK_FALSE(runs(a.plan(), "contact_solve"));
        CHECK(runs(a.plan(), "contact_solve_frictionless"));
        CHECK(runs(b.plan(), "contact_solve"));
      }
      CHECK(smooth.contact_count() > 20);
      CHECK(to_text(a.plan()).find("friction") != std::string::npos);
      const std::vector<BodyId> all = mixed.bodies();
      for (std::size_t i = 0; i < bodies.size(); i++) {
        const Pose p = *smooth.pose(bodies[i]), q = *mixed.pose(all[i]);
        CHECK(p.position == q.position);
        CHECK(p.orientation == q.orientation);
        CHECK(*smooth.velocity(bodies[i]) == *mixed.velocity(all[i]));
        CHECK(*smooth.angular_momentum(bodies[i]) == *mixed.angular_momentum(all[i]));
      }
    }
}

TEST_CASE("frictionless rows: equal bits on every backend, and a buffer a quarter smaller") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          World world = heap(precision, false, 0.6);
          Stepper stepper(settings);
          return hash_each_step(world, stepper, steps);
        },
        90, 60);
}

TEST_CASE("friction that comes and goes: the rows follow from step to step") {
  World world = heap(Precision::f32, false, 0);
  Stepper stepper;
  run(world, stepper, 60);
  CHECK(runs(stepper.plan(), "contact_solve_frictionless"));
  for (const BodyId body : world.bodies()) {
    Material rough = *world.material(body);
    rough.static_friction = rough.kinetic_friction = 0.8;
    must(world.set_material(body, rough));
  }
  run(world, stepper, 60);
  CHECK(runs(stepper.plan(), "contact_solve"));
  for (const BodyId body : world.bodies()) {
    Material smooth = *world.material(body);
    smooth.static_friction = smooth.kinetic_friction = 0;
    must(world.set_material(body, smooth));
  }
  run(world, stepper, 1);
  CHECK(runs(stepper.plan(), "contact_solve_frictionless"));
  const PropertyView friction = *world.view("friction_impulse");
  for (std::size_t i = 0; i < friction.count; i++)
    for (std::uint32_t c = 0; c < 3; c++) CHECK(friction.at(i, c) == 0);
}

namespace {

/// Balls and boxes that do not turn, in flight or on a floor; `turns`: one more ball far away does.
World still_bodies(Precision precision, bool on_floor, bool drag, bool turns) {
  World world({precision, {0, -9.81, 0}});
  if (on_floor) must(world.create_body(fixed_box({0, -1, 0}, {20, 1, 20})));
  for (int i = 0; i < 18; i++) {
    BodyDef def = ball({0.5 * (i % 3) + 0.02 * i, 0.6 + 0.9 * (i / 3), 0.3 * (i % 2)}, 0.4);
    if (i % 2 == 1) def.shapes = {ShapeDef::box({0.3, 0.4, 0.5})};
    def.rotates = false;
    def.velocity = {0.2 * i, 0, -0.1 * i};
    if (!on_floor) def.shapes[0].filter.mask = 0;
    if (drag) def.linear_drag = 0.1 * i;
    must(world.create_body(def));
  }
  if (turns) {
    BodyDef def = ball({100, 0.6, 0});
    def.angular_velocity = {1, 2, 3};
    def.shapes[0].filter.mask = 0;
    must(world.create_body(def));
  }
  return world;
}

}  // namespace

TEST_CASE("bodies that do not rotate: no rotation is computed, with the bits of steps that do") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const bool on_floor : {false, true})
      for (const bool drag : {false, true}) {
        World still = still_bodies(precision, on_floor, drag, false),
              mixed = still_bodies(precision, on_floor, drag, true);
        Stepper a, b;
        run(still, a, 90);
        run(mixed, b, 90);
        const char* left = on_floor ? "advance_still" : drag ? "fly_still_drag" : "fly_still";
        CHECK(runs(a.plan(), left) > 0);
        CHECK(runs(b.plan(), left) == 0);
        CHECK(to_text(a.plan()).find("no body rotates") != std::string::npos);
        if (on_floor) CHECK(still.contact_count() > 10);
        const std::vector<BodyId> bodies = still.bodies(), others = mixed.bodies();
        for (std::size_t i = 0; i < bodies.size(); i++) {
          CHECK(still.pose(bodies[i])->position == mixed.pose(others[i])->position);
          CHECK(still.pose(bodies[i])->orientation == Quat{});
          CHECK(*still.velocity(bodies[i]) == *mixed.velocity(others[i]));
          CHECK(*still.angular_momentum(bodies[i]) == Vec3{});
        }
      }
}

TEST_CASE("bodies that do not rotate: equal bits on every backend") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const bool on_floor : {false, true})
      check_same_bits(
          [&](const StepSettings& settings, int steps) {
            World world = still_bodies(precision, on_floor, false, false);
            Stepper stepper(settings);
            return hash_each_step(world, stepper, steps);
          },
          60, 30);
}

TEST_CASE("a body that does not rotate slides down a slope as a point, whatever its moments would be") {
  World world({Precision::f64, {0, -9.81, 0}});
  BodyDef slope = fixed_box({0, -1, 0}, {50, 1, 50});
  slope.pose.orientation = Quat{0, 0, std::sin(-0.25), std::cos(0.25)};
  slope.pose.position = rotate(slope.pose.orientation, {0, -1, 0});
  slope.material.static_friction = slope.material.kinetic_friction = 0.2;
  must(world.create_body(slope));
  BodyDef def = ball(rotate(slope.pose.orientation, {0, 0.5, 0}), 0.5);
  def.rotates = false;
  def.material = slope.material;
  const BodyId body = must(world.create_body(def));
  Stepper stepper;
  run(world, stepper, 120);
  const double along = 9.81 * (std::sin(0.5) - 0.2 * std::cos(0.5)) * 2;
  CHECK(length(*world.velocity(body)) == doctest::Approx(along).epsilon(1e-3));
  CHECK(world.pose(body)->orientation == Quat{});
}

TEST_CASE("what a body that does not rotate is not asked for") {
  World world;
  BodyDef def = ball({0, 0, 0});
  def.rotates = false;
  const BodyId body = must(world.create_body(def)), other = must(world.create_body(ball({2, 0, 0})));
  CHECK(world.mass_properties(body)->moments == Vec3{});
  const auto refused = [](const Status& status, ErrorCode code) {
    check_refused(bool(status), status.error(), code, "rotate");
  };
  refused(world.set_angular_velocity(body, {1, 0, 0}), ErrorCode::bad_argument);
  const Result<JointId> joint = world.create_joint(pin(body, {1, 0, 0}, other, {-1, 0, 0}));
  check_refused(bool(joint), joint.error(), ErrorCode::bad_joint, "rotate");
  def.angular_velocity = {1, 0, 0};
  const Result<BodyId> spinning = world.create_body(def);
  check_refused(bool(spinning), spinning.error(), ErrorCode::bad_argument, "rotate");
  must(world.set_mass_properties(body, {5, {1, 1, 1}}));
  CHECK(world.mass_properties(body)->moments == Vec3{});
  (void)must(world.add_force(body, Wrench{{0, 49.05, 0}, {7, 8, 9}}));
  Stepper stepper;
  run(world, stepper, 30);
  refused(world.set_orientation_last(body, Quat{0, 0, 1, 0}), ErrorCode::bad_argument);
  CHECK(*world.angular_velocity(body) == Vec3{});
  CHECK(*world.angular_momentum(body) == Vec3{});
  CHECK(world.pose(body)->orientation == Quat{});
}
