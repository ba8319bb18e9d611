// Pins what becomes of joint trees that are torn (docs/substeps.md#torn): a ragdoll on a driven hand that goes through a gap which it
// does not fit into comes through, closes within a second and has no more energy than when the hand stopped; nothing else feels
// it; a chain that is whole is never slowed or let through anything; equal bits on every backend.
#include <cmath>

#include "support_world.h"

using namespace worldtest;

namespace {

struct Gap {
  World world;
  BodyId hand, beside;
  std::vector<JointId> joints;

  /// A ragdoll behind a hand at so many m/s, in front of two walls 0.1 m apart.
  explicit Gap(Precision precision, double speed) : world({precision, {}}) {
    RagdollDef human = RagdollDef::human();
    human.set_damping(0);  // what turns freely tears more easily
    const Ragdoll doll = must(world.create_ragdoll(human, {}));
    joints = doll.joints;
    const BodyId arm = doll.bones[6];
    const Vec3 at = world.pose(arm)->position;
    BodyDef def = ball(at, 0.02);
    def.kind = BodyKind::kinematic;
    def.velocity = {speed, 0, 0};
    def.shapes[0].filter.mask = 0;
    hand = must(world.create_body(def));
    joints.push_back(must(world.create_joint(pin(hand, {}, arm, {}))));
    for (const double side : {-1.0, 1.0}) (void)must(world.create_body(fixed_box({at.x + 2, at.y, side * 1.05}, {0.2, 3, 1})));
    (void)must(world.create_body(fixed_box({-5, -0.5, 9}, {2, 0.5, 2})));
    beside = must(world.create_body(ball({-5, 0.5, 9})));
  }
  double gap() const {
    double widest = 0;
    for (const JointId joint : joints) widest = std::max(widest, *world.joint_separation(joint));
    return widest;
  }
};

}  // namespace

TEST_CASE("torn: a ragdoll that is dragged through what it does not fit into comes through and closes again") {
  int torn = 0;
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const double speed : {10.0, 50.0}) {
      CAPTURE(speed);
      Gap gap(precision, speed), calm(precision, 0);
      Stepper stepper, other;
      StepReport report;
      std::uint32_t through = 0, slowed = 0;
      const int until = int(std::lround((5 / speed + 0.5) / frame));
      for (int i = 0; i < until; i++) {
        report = stepper.step(gap.world, frame);
        REQUIRE(report);
        run(calm.world, other, 1);
        through = std::max(through, report.let_through);
        slowed = std::max(slowed, report.slowed);
      }
      MESSAGE("bodies let through " << through << ", slowed " << slowed);
      torn += through > 0;
      must(gap.world.set_velocity(gap.hand, {}));
      const double stopped = gap.world.kinetic_energy();
      for (int i = 0; i < 60; i++) {
        report = stepper.step(gap.world, frame);
        REQUIRE(report);
        run(calm.world, other, 1);
        CHECK(gap.world.kinetic_energy() <= 1.001 * stopped);
      }
      CHECK(gap.gap() < 1e-4);
      CHECK(report.let_through == 0);
      CHECK(report.slowed == 0);
      CHECK(states(gap.world, {gap.beside}) == states(calm.world, {calm.beside}));
    }
  // at 50 m/s; at 10 nothing is torn since the slow means of contacts are bounded
  CHECK(torn >= 2);
}

TEST_CASE("torn: what is whole is let through nothing and keeps its spin, however fast") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({precision, {}});
    (void)must(world.create_body(fixed_box({0, -3, 0}, {5, 0.5, 5})));
    const std::vector<BodyId> links = add_chain(world, {0, 0, 0}, 5);
    must(world.set_angular_velocity(links.back(), {0, 0, 5000}));  // about the link's own axis
    Stepper stepper;
    for (int i = 0; i < 30; i++) {
      const StepReport& report = stepper.step(world, frame);
      REQUIRE(report);
      CHECK(report.let_through == 0);
      CHECK(report.slowed == 0);
    }
    CHECK(world.angular_velocity(links.back())->z > 4900);
  }
}

TEST_CASE("torn: the same bits in lanes, in threads, on GL and in all mixes") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Gap gap(precision, 70);
    Stepper first(lanes(1));
    StepReport report;
    std::vector<std::byte> before;
    for (int i = 0; i < 60 && report.let_through == 0; i++) {
      before = gap.world.snapshot();
      report = first.step(gap.world, frame);
      REQUIRE(report);
    }
    REQUIRE(report.let_through > 0);
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          must(gap.world.restore(before));
          Stepper stepper(settings);
          return hash_each_step(gap.world, stepper, steps);
        },
        20, 5);
  }
}
