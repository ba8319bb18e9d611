// A plate that spins on its flat side stays on a floor without friction. The points of its contact move far in a
// sub-step, so it is an impact in each, and what an impact left of the fall sank it through the floor (1.4 mm a step of
// 1/30 s).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support_world.h"

using namespace worldtest;

namespace {

/// How deep a body has sunk [m], and what is left of its spin, of what it had.
struct Spun {
  double depth = 0, spin = 0;
};

/// A box or a cylinder of random size after two seconds at 20 to 200 rad/s about the vertical.
Spun spun(unsigned seed, double dt) {
  std::mt19937 dice(seed * 19 + 3);
  const auto between = [&](double low, double high) { return low + (high - low) * (double(dice()) / 4294967296.0); };
  World world({seed % 2 == 0 ? Precision::f32 : Precision::f64, {0, -9.81, 0}});
  const double restitution = seed % 4 < 2 ? 0.0 : between(0, 0.8);
  const Material smooth{.static_friction = 0, .kinetic_friction = 0, .restitution = restitution};
  BodyDef floor;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::box({5, 0.5, 5})};
  floor.pose.position = {0, -0.5, 0};
  floor.material = smooth;
  must(world.create_body(floor));
  const double half = between(0.005, 0.05), wide = half * between(1, 10), spin = between(20, 200);
  BodyDef plate;
  plate.shapes = {seed % 3 == 0 ? ShapeDef::cylinder(wide, half) : ShapeDef::box({wide, half, wide * between(0.5, 1)})};
  plate.pose.position = {0, half, 0};
  plate.angular_velocity = {0, spin, 0};
  plate.material = smooth;
  const BodyId body = must(world.create_body(plate));
  Stepper stepper;
  for (int i = 0; i * dt < 2; i++) REQUIRE(stepper.step(world, dt));
  return {half - must(world.pose(body)).position.y, must(world.angular_velocity(body)).y / spin};
}

}  // namespace

TEST_CASE("what spins on its flat side does not sink into a floor") {
  for (const double dt : {1 / 120.0, 1 / 60.0, 1 / 30.0}) {
    const double fall = 9.81 * dt * dt / 32;  // in a sub-step
    double deepest = 0, least_spin = 1;
    for (unsigned seed = 1; seed <= 60; seed++) {
      const Spun s = spun(seed, dt);
      deepest = std::max(deepest, s.depth / fall);
      least_spin = std::min(least_spin, s.spin);
    }
    MESSAGE("steps of ", dt, " s: at most ", deepest, " times as deep as it falls in a sub-step; spin left ",
            least_spin);
    CHECK(deepest < 1.01);
    CHECK(least_spin > 0.999);
  }
}
