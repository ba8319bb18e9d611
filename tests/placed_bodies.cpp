// Pins what follows a body's being placed (docs/impulses.md): its contacts are visited more often while it settles, by
// those contacts alone, and no other island feels it by a bit; and the velocity that is read after the very first
// sub-step.
#include <algorithm>
#include <string>

#include "pcphys/constants.h"
#include "support_world.h"

using namespace worldtest;

namespace {

int visits(const Stepper& stepper) {
  return int(std::ranges::count_if(stepper.plan().entries, [](const PlanEntry& e) {
    return e.kind == PlanEntry::Kind::kernel && std::string(kernel_name(e)) == "contact_solve_placed";
  }));
}

/// Two balls that lie on each other in a floor, all of them a little too deep.
std::vector<BodyId> add_pair(World& world, double x) {
  return {must(world.create_body(ball({x, 0.4999, 0}))), must(world.create_body(ball({x, 1.4997, 0})))};
}
World with_floor(Precision precision = Precision::f32) {
  World world({.precision = precision});
  (void)must(world.create_body(fixed_box({0, -0.5, 0}, {50, 0.5, 50})));
  return world;
}

}  // namespace

TEST_CASE("placed bodies: more visits while they settle, where they touch something") {
  World world = with_floor();
  const BodyId high = must(world.create_body(ball({0, 20, 0})));
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(visits(stepper) == 0);  // touches nothing
  const std::vector<BodyId> pair = add_pair(world, 5);
  const int each = 2 * int(constants::rounds - 1) * int(stepper.settings().substeps);
  for (unsigned i = 1; i < constants::rounds; i++) {
    run(world, stepper, 1);
    CHECK(visits(stepper) == each);
  }
  run(world, stepper, 1);
  CHECK(visits(stepper) == 0);
  must(world.set_velocity(high, {1, 0, 0}));
  must(world.set_velocity(pair[1], {0, 0.1, 0}));
  run(world, stepper, 1);
  CHECK(visits(stepper) == 0);  // was there before
  must(world.set_pose(pair[1], {{5.01, 1.4997, 0}, {}}));
  run(world, stepper, 1);
  CHECK(visits(stepper) == each);
}

TEST_CASE("placed bodies: what others do does not change by a bit") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World alone = with_floor(precision), visited = with_floor(precision);
    const std::vector<BodyId> a = add_pair(alone, 0), b = add_pair(visited, 0);
    Stepper stepper_a, stepper_b;
    for (int i = 0; i < 60; i++) {
      if (i % 7 == 0) (void)add_pair(visited, 3 + i);
      run(alone, stepper_a, 1);
      run(visited, stepper_b, 1);
      CHECK(states(alone, a) == states(visited, b));
    }
  }
}

TEST_CASE("placed bodies: equal hashes in all lanes and mixes, also among others that have settled") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const auto hashes_of = [&](const StepSettings& settings, int steps) {
      World world = with_floor(precision);
      for (int i = 0; i < 9; i++) (void)add_pair(world, 2 * i - 9);
      Stepper stepper(settings);
      std::vector<std::uint64_t> all;
      for (int i = 0; i < steps; i++) {
        if (i == 19)
          for (int k = 0; k < 4; k++) (void)must(world.create_body(ball({4.0 * k - 8.5, 2.4, 0.1})));
        run(world, stepper, 1);
        all.push_back(world.hash());
      }
      return all;
    };
    check_same_bits(hashes_of, 24, 24);
  }
}

TEST_CASE("placed bodies: a snapshot in between goes on alike") {
  World world = with_floor();
  (void)add_pair(world, 0);
  Stepper stepper, another;
  run(world, stepper, 5);
  const std::vector<std::byte> middle = world.snapshot();
  run(world, stepper, 20);
  const std::uint64_t end = world.hash();
  must(world.restore(middle));
  run(world, another, 20);
  CHECK(world.hash() == end);
}

// The stored velocity lags half a sub-step, which the first sub-step makes up for by half a kick: what friction answers
// to that is half too, and a velocity read after it must know.
TEST_CASE("the velocity after a single first sub-step is that of a body that slides") {
  constexpr double mu = 0.25, push = 6, dt = 0.01;
  World world = with_floor(Precision::f64);
  BodyDef def;
  def.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
  def.mass = 1;
  def.pose.position = {0, 0.5, 0};
  def.material.static_friction = def.material.kinetic_friction = mu;
  def.material.friction_rule = Combine::minimum;
  const BodyId body = must(world.create_body(def));
  (void)must(world.add_force(body, Wrench{{push, 0, 0}, {}}));
  StepSettings single;
  single.substeps = 1;
  Stepper stepper(single);
  for (int i = 1; i <= 5; i++) {
    run(world, stepper, 1, dt);
    CHECK(must(world.velocity(body)).x == doctest::Approx((push - mu * 9.81) * i * dt).epsilon(1e-4));
  }
}
