// Pins that limits hold where a contact turns a joint over them, in the sub-step in which it strikes (tree_limits). With only those limits that
// act before the contacts, 19 of these 300 arms go beyond by more than a degree, the worst by 11.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "scenes/metrics.h"
#include "support_world.h"

using namespace worldtest;

namespace {

/// An arm on a cone of 0.1 to 0.6 rad, at rest in the middle of it, that a ball of 0.4 to 40 kg strikes from the side at 1 to 8 m/s.
double most_beyond(unsigned seed) {
  std::mt19937 dice(seed * 7 + 1);
  const auto between = [&](double low, double high) { return low + (high - low) * (double(dice()) / 4294967296.0); };
  const double speed = between(1, 8), along = between(0.1, 0.55);
  const double density = std::exp(between(std::log(100.0), std::log(10000.0)));
  const double cone = between(0.1, 0.6), angle = between(0, 6.2832);
  const Vec3 side{0, std::cos(angle), std::sin(angle)};

  World world({.precision = seed % 2 == 0 ? Precision::f32 : Precision::f64, .gravity = {0, 0, 0}});
  BodyDef torso, arm, ball;
  torso.shapes = {ShapeDef::box({0.2, 0.2, 0.2})};
  arm.shapes = {ShapeDef::box({0.3, 0.05, 0.05})};
  arm.pose.position = {0.55, 0, 0};
  ball.shapes = {ShapeDef::sphere(0.1)};
  ball.density = density;
  ball.pose.position = Vec3{0.25 + along, 0, 0} + side * 0.3;
  ball.velocity = side * -speed;
  JointDef shoulder;
  shoulder.a = must(world.create_body(torso));
  shoulder.b = must(world.create_body(arm));
  shoulder.frame_a.position = {0.22, 0, 0};
  shoulder.frame_b.position = {-0.33, 0, 0};
  shoulder.freedom = AngleFreedom::cone_and_twist(cone, 0.3);
  must(world.create_joint(shoulder));
  must(world.create_body(ball));
  Stepper stepper;
  double most = 0;
  for (int i = 0; i < 60; i++) {
    REQUIRE(stepper.step(world, 1 / 60.0));
    const Quat a = world.pose(shoulder.a)->orientation, b = world.pose(shoulder.b)->orientation;
    most = std::max(most, scenes::limit_excess(shoulder, a, b).any);
  }
  return most;
}

}  // namespace

TEST_CASE("300 arms that a ball strikes stay within a degree of their limits") {
  double worst = 0;
  for (unsigned seed = 0; seed < 300; seed++) worst = std::max(worst, most_beyond(seed));
  MESSAGE("the worst goes beyond by " << worst << " rad");
  CHECK(worst <= 3.14159265 / 180);
}
