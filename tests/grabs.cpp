// Pins what a pin with a largest force does (JointDef::largest_force, World::grab): what it holds it holds closed, what
// it cannot hold it pulls by that force and no more, so that no drag tears a ragdoll; momentum stays; equal bits on
// every backend.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "support_world.h"

using namespace worldtest;

namespace {

/// A ragdoll before two walls with a gap that it may or may not fit through, and a hand that grabs one of its bones.
struct Drag {
  World world;
  BodyId hand;
  JointId grip;
  Ragdoll doll;

  Drag(Precision precision, unsigned seed) : world({.precision = precision}) {
    std::mt19937 draw(seed);
    const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(draw); };
    RagdollDef human = RagdollDef::human();
    human.set_damping(0);
    doll = must(world.create_ragdoll(human, {}));
    const BodyId bone = doll.bones[std::size_t(between(0, double(doll.bones.size()) - 1e-9))];
    const Vec3 at = world.pose(bone)->position;
    BodyDef def = ball(at, 0.02);
    def.kind = BodyKind::kinematic;
    def.velocity = {between(1, 50), 0, 0};
    def.shapes[0].filter.mask = 0;
    hand = must(world.create_body(def));
    grip = must(world.grab(hand, bone, at));
    const double half_gap = between(0.02, 0.4);
    for (const double side : {-1.0, 1.0})
      (void)must(world.create_body(fixed_box({at.x + 2, at.y, side * (1 + half_gap)}, {0.2, 3, 1})));
  }
  double gap() const {
    double widest = 0;
    for (const JointId joint : doll.joints) widest = std::max(widest, *world.joint_separation(joint));
    return widest;
  }
  double energy() const { return world.kinetic_energy() + world.potential_energy(); }
  double fastest() const {
    double most = 0;
    for (const BodyId bone : doll.bones) most = std::max(most, length(*world.velocity(bone)));
    return most;
  }
};

}  // namespace

TEST_CASE("grab: no drag tears a ragdoll, whatever it is dragged through") {
  double widest = 0, closed = 0, fastest = 0, made = 0;
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (unsigned seed = 1; seed <= 24; seed++) {
      CAPTURE(seed);
      Drag drag(precision, seed);
      Stepper stepper;
      const double speed = drag.world.velocity(drag.hand)->x;
      for (int i = 0; i < int((5 / speed + 0.5) / frame); i++) {
        REQUIRE(stepper.step(drag.world, frame));
        widest = std::max(widest, drag.gap());
        fastest = std::max(fastest, drag.fastest() / (speed + 10));
      }
      must(drag.world.destroy(drag.grip));
      for (int i = 0; i < 2; i++) REQUIRE(stepper.step(drag.world, frame));  // it is let go of within the first
      const double left = drag.energy();
      for (int i = 0; i < 60; i++) {
        REQUIRE(stepper.step(drag.world, frame));
        made = std::max(made, (drag.energy() - left) / (std::fabs(left) + 1000));
      }
      closed = std::max(closed, drag.gap());
    }
  MESSAGE("joints open by " << widest << " m, by " << closed << " m a second after; speeds up to " << fastest
                            << " of the hand's and 10 m/s; energy made " << made);
  CHECK(widest < 1e-3);
  CHECK(closed < 1e-5);
  CHECK(fastest < 3);
  CHECK(made < 0.03);  // what is wedged between the walls is pushed out
}

namespace {

/// How far the point that was grabbed is from the hand, after each of 240 steps: of a hand that goes round at 2 m/s
/// with one of ten bones [m].
std::vector<double> gaps_of_grip(int draw) {
  World world({.precision = draw % 2 == 0 ? Precision::f64 : Precision::f32});
  const Ragdoll doll = must(world.create_ragdoll(RagdollDef::human(), {{0, 2, 0}, {}}));
  const BodyId bone = doll.bones[std::size_t(draw % 10 + 1)];
  const Vec3 at = world.pose(bone)->position;
  BodyDef def = ball(at, 0.02);
  def.kind = BodyKind::kinematic;
  def.shapes[0].filter.mask = 0;
  const BodyId hand = must(world.create_body(def));
  const JointId grip = must(world.grab(hand, bone, at));
  Stepper stepper;
  std::vector<double> gaps;
  for (int i = 0; i < 240; i++) {
    const double angle = (0.05 + 0.002 * draw) * i + draw;
    must(world.set_velocity(hand, {2 * std::cos(angle), 2 * std::sin(angle), 0}));
    REQUIRE(stepper.step(world, frame));
    gaps.push_back(*world.joint_separation(grip));
  }
  return gaps;
}

}  // namespace

TEST_CASE("grab: what a hand can hold follows it, on the point that it grabbed") {
  constexpr int draws = 40;
  double open = 0, mean = 0, widest = 0;
  int wide = 0;  // while its limbs strike each other; of 1,000 draws 8 go beyond
  for (int draw = 0; draw < draws; draw++) {
    const std::vector<double> gaps = gaps_of_grip(draw);
    const double most = *std::ranges::max_element(gaps);
    open += double(std::ranges::count_if(gaps, [](double gap) { return gap > 1e-3; })) / draws;
    mean += most / draws;
    widest = std::max(widest, most);
    wide += most > 0.03;
  }
  MESSAGE("open by more than a millimetre after " << open << " steps of 240; at most by " << mean
                                                  << " m in the mean of " << draws << " draws, " << widest
                                                  << " m in the worst");
  CHECK(open < 18);
  CHECK(mean < 0.005);
  CHECK(wide <= 1);
  CHECK(widest < 0.04);
}

TEST_CASE("grab: what a pin cannot hold it pulls by its largest force") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({.precision = precision});
    BodyDef def = ball({0, 10, 0}, 0.1);
    def.mass = 2;
    const BodyId weight = must(world.create_body(def));
    JointDef joint = pin(world.ground(), {0, 10, 0}, weight, {});
    joint.largest_force = 5;
    const JointId grip = must(world.create_joint(joint));
    CHECK(world.joint(grip)->largest_force == 5);
    Stepper stepper;
    for (int i = 0; i < 60; i++) REQUIRE(stepper.step(world, frame));
    const double down = 9.81 - 5 / 2.0;
    CHECK(world.velocity(weight)->y == doctest::Approx(-down).epsilon(1e-3));
    CHECK(world.pose(weight)->position.y == doctest::Approx(10 - down / 2).epsilon(1e-3));
  }
}

TEST_CASE("grab: pins that give way between free bodies keep their momentum") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (unsigned seed = 1; seed <= 8; seed++) {
      CAPTURE(seed);
      std::mt19937 draw(seed);
      const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(draw); };
      World world({.precision = precision});
      must(world.set_gravity({}));
      std::vector<BodyId> bodies;
      for (int i = 0; i < 4; i++) {
        BodyDef def = ball({double(i), 0, 0}, 0.1);
        def.velocity = {between(-5, 5), between(-5, 5), between(-5, 5)};
        bodies.push_back(must(world.create_body(def)));
        if (i == 0) continue;
        JointDef joint = pin(bodies[std::size_t(i) - 1], {0.5, 0, 0}, bodies.back(), {-0.5, 0, 0});
        if (i % 2 == 1) joint.largest_force = between(1, 1000);
        (void)must(world.create_joint(joint));
      }
      const Vec3 p = world.momentum(), l = world.angular_momentum();
      Stepper stepper;
      for (int i = 0; i < 120; i++) REQUIRE(stepper.step(world, frame));
      const double rounding = precision == Precision::f32 ? 2e-5 : 1e-12;
      CHECK(length(world.momentum() - p) < rounding * 100);
      CHECK(length(world.angular_momentum() - l) < rounding * 300);
    }
}

TEST_CASE("grab: the same bits in lanes, in threads, on GL and in all mixes") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Drag drag(precision, 5);
    Stepper first(lanes(1));
    for (int i = 0; i < 10; i++) REQUIRE(first.step(drag.world, frame));
    const std::vector<std::byte> before = drag.world.snapshot();
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          must(drag.world.restore(before));
          Stepper stepper(settings);
          return hash_each_step(drag.world, stepper, steps);
        },
        20, 5);
  }
}

TEST_CASE("grab: what is refused") {
  World world;
  const BodyId free = must(world.create_body(ball({0, 1, 0}))),
               fixed = must(world.create_body(fixed_box({0, 5, 0}, {1, 1, 1})));
  BodyDef def = ball({0, 2, 0});
  def.kind = BodyKind::kinematic;
  const BodyId hand = must(world.create_body(def));
  CHECK(world.grab(free, free, {}).error().code == ErrorCode::bad_joint);
  CHECK(world.grab(hand, fixed, {}).error().code == ErrorCode::bad_joint);
  CHECK(world.grab(hand, {}, {}).error().code == ErrorCode::stale_id);
  CHECK(!world.grab(hand, free, {std::nan(""), 0, 0}));
  JointDef joint = pin(hand, {}, free, {});
  for (const double force : {0.0, -1.0, std::nan(""), 1e300}) {
    joint.largest_force = force;
    CHECK(!world.create_joint(joint));
  }
  CHECK(world.joint_count() == 0);
}
