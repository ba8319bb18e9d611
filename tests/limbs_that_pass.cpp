// A limb that passes something keeps its motion: rows of what its tree might have sent together let go where the shapes
// have not met. (Without that 16 of 200 are struck. What is left is foreseen to meet, as limbs fly before their joints
// draw them round.)
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "support_world.h"

using namespace worldtest;

namespace {

/// Two boxes on a ball joint that fly free and turn about their common centre at 2 to 20 rad/s; a fixed ball stands 0.3
/// to 5 mm beyond the circle of their ends.
Vec3 velocity_after(unsigned seed, bool with_ball) {
  std::mt19937 dice(seed * 17 + 9);
  const auto between = [&](double low, double high) { return low + (high - low) * (double(dice()) / 4294967296.0); };
  const double spin = between(2, 20), clear = between(3e-4, 5e-3), radius = between(0.02, 0.2), angle = between(0.5, 6);
  World world({seed % 2 == 0 ? Precision::f32 : Precision::f64, {0, 0, 0}});
  JointDef joint;
  joint.frame_a.position = {0.3, 0, 0};
  joint.frame_b.position = {-0.3, 0, 0};
  BodyId bodies[2];
  for (int i = 0; i < 2; i++) {
    BodyDef limb;
    limb.shapes = {ShapeDef::box({0.28, 0.05, 0.05})};
    limb.pose.position = {i == 0 ? -0.3 : 0.3, 0, 0};
    limb.angular_velocity = {0, 0, spin};
    limb.velocity = cross(limb.angular_velocity, limb.pose.position);
    bodies[i] = must(world.create_body(limb));
  }
  joint.a = bodies[0];
  joint.b = bodies[1];
  must(world.create_joint(joint));
  const double out = std::hypot(0.58, 0.05) + radius + clear;
  BodyDef ball;
  ball.kind = BodyKind::fixed;
  ball.shapes = {ShapeDef::sphere(radius)};
  ball.pose.position = {out * std::cos(angle), out * std::sin(angle), 0};
  if (with_ball) must(world.create_body(ball));
  Stepper stepper;
  for (int i = 0; i < 60; i++) REQUIRE(stepper.step(world, 1 / 60.0));
  return *world.velocity(bodies[1]);
}

}  // namespace

TEST_CASE("200 pairs of limbs that turn past a ball keep their motion") {
  int struck = 0;
  double worst = 0;
  for (unsigned seed = 0; seed < 200; seed++) {
    const Vec3 alone = velocity_after(seed, false), past = velocity_after(seed, true);
    const double off = length(past - alone) / length(alone);
    worst = std::max(worst, off);
    if (off > 1e-4) struck++;
  }
  MESSAGE(struck << " are struck, the worst by " << worst);
  CHECK(struck <= 8);
}
