// Overlaps of bodies on joints are undone by poses: what a host has set into each other comes apart, and no motion is
// left of it.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "support_world.h"

using namespace worldtest;

namespace {

constexpr double size = 0.05;  // half the width of limbs [m]

/// Two limbs on a ball joint, at rest without gravity, the first held by the world or not. A fixed box, a free one,
/// turned at random, or another such pair overlaps the second by 1 to 30 mm.
struct Overlap {
  World world;
  std::mt19937 dice;

  Overlap(Precision precision, unsigned seed) : world({precision, {0, 0, 0}}), dice(seed * 29 + 5) {
    add_pair({}, seed % 2 == 0);
    const double along = between(-0.1, 0.1), above = 2 * size - between(1e-3, 30e-3);
    if (seed % 3 == 2) {
      add_pair({along, above, 0}, false);
      return;
    }
    BodyDef def;
    def.kind = seed % 3 == 0 ? BodyKind::fixed : BodyKind::dynamic;
    def.pose = {{0.9 + along, above, 0}, axis_angle({0, 1, 0}, between(0, 3))};
    def.shapes = {ShapeDef::box({0.2, size, 0.1})};
    (void)must(world.create_body(def));
  }

  double between(double low, double high) { return low + (high - low) * (double(dice()) / 4294967296.0); }

  void add_pair(Vec3 at, bool held) {
    JointDef joint;
    joint.a = world.ground();
    joint.frame_a.position = at;
    joint.frame_b.position = {-0.3, 0, 0};
    for (int i = 0; i < 2; i++) {
      BodyDef def;
      def.pose.position = at + Vec3{0.3 + 0.6 * i, 0, 0};
      def.shapes = {ShapeDef::box({0.28, size, size})};
      joint.b = must(world.create_body(def));
      if (i > 0 || held) (void)must(world.create_joint(joint));
      joint.a = joint.b;
      joint.frame_a.position = {0.3, 0, 0};
    }
  }

  double deepest() const {
    double least = 0;
    for (const Contact& contact : world.contacts())
      for (const Contact::Point& point : contact.points) least = std::min(least, point.separation);
    return -least;
  }
};

}  // namespace

TEST_CASE("overlaps of 120 trees come apart, and nothing moves of it at any step") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    double energy = 0, left = 0, momentum = 0, open = 0;
    for (unsigned seed = 0; seed < 120; seed++) {
      CAPTURE(seed);
      Overlap scene(precision, seed);
      Stepper stepper;
      for (int i = 0; i < 60; i++) {
        REQUIRE(stepper.step(scene.world, frame));
        energy = std::max(energy, scene.world.kinetic_energy());
        for (const JointId joint : scene.world.joints())
          open = std::max(open, must(scene.world.joint_separation(joint)));
      }
      left = std::max(left, scene.deepest());
      if (seed % 2 == 1 && seed % 3 != 0) momentum = std::max(momentum, length(scene.world.momentum()));
    }
    MESSAGE("at most " << energy << " J at any step, " << momentum << " N s of what is free; overlaps left " << left
                       << " m, joints open by " << open << " m");
    CHECK(energy < 1e-9);
    CHECK(momentum < 1e-5);
    CHECK(left < 1e-5);
    CHECK(open < 1e-6);
  }
}
