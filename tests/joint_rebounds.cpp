// Pins limits of joints that throw back (AngleFreedom::restitution): the rate that a limit is met with comes back e
// times, both momenta are kept and no energy comes, of hinges and cones, of free trees and of one that hangs; slow
// meetings stop; CPU and GL agree to the bit.
#include <algorithm>
#include <cmath>

#include "support_world.h"

using namespace worldtest;

namespace {

/// Two bars end to end along z that turn against each other about x, a hinge or the side of a cone, 0.3 rad each way.
struct Bars {
  World world;
  Stepper stepper;
  BodyId a, b;
  Bars(Precision precision, const AngleFreedom& freedom, double threshold = 0) : world(WorldDef{precision, {}}) {
    a = must(world.create_body(link_at({0, 5, 0.2})));
    b = must(world.create_body(link_at({0, 5, -0.2})));
    JointDef joint = pin(a, {0, 0, -0.2}, b, {0, 0, 0.2});
    joint.freedom = freedom;
    if (freedom.kind == AngleFreedom::Kind::cone_twist)  // the frames' x axes along the bars
      joint.frame_a.orientation = joint.frame_b.orientation = axis_angle({0, 1, 0}, 0.5 * 3.14159265358979);
    (void)must(world.create_joint(joint));
    must(world.set_velocity(a, {0, -0.2, 0}));  // so that the pin is at rest
    must(world.set_velocity(b, {0, -0.2, 0}));
    must(world.set_angular_velocity(a, {-1, 0, 0}));
    must(world.set_angular_velocity(b, {1, 0, 0}));
    StepSettings settings;
    settings.restitution_threshold = threshold;
    must(stepper.configure(settings));
  }
  double rate() const { return must(world.angular_velocity(b)).x - must(world.angular_velocity(a)).x; }
};
AngleFreedom with(AngleFreedom freedom, double restitution) {
  freedom.restitution = restitution;
  return freedom;
}

}  // namespace

/// Limits that are met in any sub-step of a step: what a throw in the last one changed is not read as if it went on, at
/// four times the energy.
TEST_CASE("velocities that are read in the step of a throw have its energy") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (int i = 0; i < 40; i++) {
      const double limit = 0.2 + 0.003 * i;
      CAPTURE(limit);
      Bars bars(precision, with(AngleFreedom::hinge(-limit, limit), 1));
      const double energy = bars.world.kinetic_energy();
      for (int step = 0; step < 60; step++) {
        run(bars.world, bars.stepper, 1, 1.0 / 60);
        CHECK(bars.world.kinetic_energy() <= energy * 1.001);
      }
    }
}

TEST_CASE("a limit is left at e times the rate that it is met with, momenta stay, and no energy comes") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const AngleFreedom& freedom : {AngleFreedom::hinge(-0.3, 0.3), AngleFreedom::cone_and_twist(0.3, 1)})
      for (const double e : {0.0, 0.5, 1.0}) {
        CAPTURE(e);
        CAPTURE(int(freedom.kind));
        Bars bars(precision, with(freedom, e));
        const double rounding = precision == Precision::f32 ? 2e-6 : 1e-13;
        const Vec3 momentum = bars.world.momentum(), spin = bars.world.angular_momentum();
        const double energy = bars.world.kinetic_energy();
        double before = bars.rate(), after = before;
        for (int i = 0; i < 240 && after > 0.9 * before; i++) {
          before = after;
          run(bars.world, bars.stepper, 1, 1.0 / 240);
          after = bars.rate();
          CHECK(bars.world.kinetic_energy() <= energy * (1 + 1e-5));  // second order
        }
        if (e == 0) {  // what yields stops in a few steps
          run(bars.world, bars.stepper, 4, 1.0 / 240);
          after = bars.rate();
        }
        CHECK(std::abs(after / before + e) < (e == 0 ? 1e-2 : 2e-3));
        CHECK(length(bars.world.momentum() - momentum) < rounding);
        CHECK(length(bars.world.angular_momentum() - spin) < rounding);
      }
}

TEST_CASE("what comes slower than the threshold stops") {
  Bars bars(Precision::f64, with(AngleFreedom::hinge(-0.3, 0.3), 1), 5);
  run(bars.world, bars.stepper, 60, 1.0 / 240);
  CHECK(std::abs(bars.rate()) < 1e-4);
}

TEST_CASE("a restitution of limits outside of 0 to 1 is refused") {
  World world;
  const BodyId a = must(world.create_body(ball({0, 5, 0}))), b = must(world.create_body(ball({2, 5, 0})));
  JointDef joint = pin(a, {1, 0, 0}, b, {-1, 0, 0});
  for (const double e : {-0.1, 1.1, std::nan("")}) {
    joint.freedom = with(AngleFreedom::hinge(-1, 1), e);
    CHECK_REFUSED(world, world.create_joint(joint), ErrorCode::bad_joint, "The restitution of a joint's limits is");
  }
}

TEST_CASE("ragdolls whose joints throw back: the same bits in lanes, threads, on the GPU and wherever stages run") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          World world(WorldDef{precision, {0, -9.81, 0}});
          (void)must(world.create_body(fixed_box({0, -0.5, 0}, {20, 0.5, 20})));
          RagdollDef human = RagdollDef::human();
          for (BoneDef& bone : human.bones) bone.freedom.restitution = 0.7;
          for (int i = 0; i < 5; i++) {
            const Ragdoll doll = must(world.create_ragdoll(human, {{1.5 * i, 0.5 + 0.1 * i, 0}, {}}, {0, -2, 0}));
            must(world.set_angular_velocity(doll.bones[std::size_t(i)], {9, -7, 5}));
          }
          StepSettings with = settings;
          with.restitution_threshold = 0.5;
          Stepper stepper(with);
          return hash_each_step(world, stepper, steps);
        },
        40, 4);
}
