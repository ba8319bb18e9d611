// Pins that what stands stays where it is when the length of the step changes: stiffness of contacts goes by the
// sub-step, and would pump.
#include <functional>
#include <random>

#include "support_world.h"

using namespace worldtest;

namespace {

constexpr int rows = 15;

/// How far the bodies of a pyramid of 120 cubes of 1 m went in 10 s, at most [m].
double most_moved(Precision precision, const std::function<double(int)>& dt) {
  World world({.precision = precision});
  (void)must(world.create_body(fixed_box({0, -0.5, 0}, {50, 0.5, 50})));
  std::vector<BodyId> cubes;
  std::vector<Vec3> places;
  for (int row = 0; row < rows; row++)
    for (int i = 0; i < rows - row; i++) {
      places.push_back({1.01 * (i - 0.5 * (rows - row)), 0.5 + row, 0});
      BodyDef def = fixed_box(places.back(), {0.5, 0.5, 0.5});
      def.kind = BodyKind::dynamic;
      def.mass = 1;
      cubes.push_back(must(world.create_body(def)));
    }
  Stepper stepper;
  double time = 0;
  for (int i = 0; time < 10; i++) {
    REQUIRE(stepper.step(world, dt(i)));
    time += dt(i);
  }
  double most = 0;
  for (std::size_t i = 0; i < cubes.size(); i++)
    most = std::max(most, length(world.pose(cubes[i])->position - places[i]));
  return most;
}

}  // namespace

TEST_CASE(
    "changing steps: a pyramid stands in steps of 1/60 and 1/30 s by turns, and of any length between 1/144 and 1/30 "
    "s") {
  std::mt19937 draw(1);
  std::vector<double> lengths(2000);
  for (double& length : lengths) length = std::uniform_real_distribution(1 / 144.0, 1 / 30.0)(draw);
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const double even = most_moved(precision, [](int) { return 1 / 30.0; });
    const double by_turns = most_moved(precision, [](int i) { return i % 2 ? 1 / 30.0 : 1 / 60.0; });
    const double at_random = most_moved(precision, [&](int i) { return lengths[std::size_t(i)]; });
    MESSAGE("a pyramid of 120 moves by " << even << ", " << by_turns << " and " << at_random << " m");
    CHECK(even <= 0.025);
    CHECK(by_turns <= 0.04);  // 18.6 where stiffness changes with each step
    CHECK(at_random <= 0.04);
  }
}

TEST_CASE("changing steps: what wakes has the bits that it has beside what never slept") {
  const auto stack = [](bool beside) {
    World world({.precision = Precision::f64});
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
    std::vector<BodyId> boxes;
    for (int i = 0; i < 5; i++) {
      BodyDef def = fixed_box({0, 0.5 + i, 0}, {0.5, 0.5, 0.5});
      def.kind = BodyKind::dynamic;
      boxes.push_back(must(world.create_body(def)));
    }
    if (beside) {
      BodyDef def = ball({100, 50, 0});
      def.velocity = {1, 0, 0};
      (void)must(world.create_body(def));
    }
    StepSettings settings;
    settings.sleep = true;
    Stepper stepper(settings);
    run(world, stepper, 60, 1 / 30.0);
    REQUIRE(*world.is_asleep(boxes[0]));
    run(world, stepper, 30, 1 / 120.0);
    must(world.wake(boxes[0]));
    run(world, stepper, 30, 1 / 120.0);
    return world.pose(boxes[4])->position;
  };
  const Vec3 alone = stack(false), beside = stack(true);
  CHECK(alone.x == beside.x);
  CHECK(alone.y == beside.y);
  CHECK(alone.z == beside.z);
}
