// Pins motors and springs: what their torques do, on joints in trees and beside them, on every lane width and on GL;
// that stiff ones make no energy and both momenta stay; that they may change between steps; what is refused; and that
// worlds without run as before.
#include <algorithm>

#include "support_physics.h"
#include "support_world.h"

using namespace physics;
using worldtest::must;

namespace {

constexpr double inertia = 0.02;

BodyId rotor(Run& run, Vec3 position = {}) {
  BodyDef def = free_body(1, {inertia, inertia, inertia});
  def.pose.position = position;
  return run.add(def);
}
JointDef hinge(BodyId a, BodyId b, Vec3 at_a = {}, Vec3 at_b = {}) {
  JointDef def;
  def.a = a;
  def.b = b;
  def.frame_a.position = at_a;
  def.frame_b.position = at_b;
  def.freedom = AngleFreedom::hinge();
  return def;
}
SpringDef spring_between(BodyId a, BodyId b, double length, double stiffness) {
  SpringDef def;
  def.a = a;
  def.b = b;
  def.rest_length = length;
  def.stiffness = stiffness;
  return def;
}
double total_energy(const World& world) {
  return world.kinetic_energy() + world.potential_energy() + world.spring_energy();
}

/// A motor, a spring on a joint, a spring between points, in a tree, on a loop and between free bodies; something of
/// everything.
void workshop(World& world) {
  std::vector<BodyId> arm;
  for (int i = 0; i < 4; i++) {
    BodyDef def;
    def.shapes = {ShapeDef::box({0.25, 0.05, 0.05})};
    def.pose.position = {0.5 * i + 0.25, 2, 0};
    arm.push_back(must(world.create_body(def)));
    JointDef joint = hinge(i == 0 ? world.ground() : arm[std::size_t(i) - 1], arm.back(),
                           i == 0 ? Vec3{0, 2, 0} : Vec3{0.25, 0, 0}, {-0.25, 0, 0});
    joint.frame_a.orientation = joint.frame_b.orientation = axis_angle({0, 1, 0}, 1.57079632679489662);
    if (i % 2 == 0) joint.motor = {3, 20};
    if (i > 0) joint.spring = {50.0 * i, 1, axis_angle({1, 0, 0}, 0.2)};
    must(world.create_joint(joint));
  }
  must(world.create_spring(spring_between(arm[1], arm[3], 1, 1e6)));
  SpringDef held = spring_between(world.ground(), arm[2], 1, 300);
  held.damping = 5;
  held.anchor_a = {1.2, 3.5, 0};
  held.anchor_b = {0.1, 0.05, 0};
  must(world.create_spring(held));
  JointDef closing =
      hinge(arm[3], must(world.create_body(worldtest::ball({2.2, 2, 0}, 0.1))), {0.25, 0, 0}, {0.05, 0, 0});
  must(world.create_joint(closing));
  closing.motor = {-2, 1};
  closing.spring = {5, 0.1, {}};
  must(world.create_joint(closing));  // beside the first: a row
  const BodyId free = must(world.create_body(worldtest::ball({-1, 2, 0}, 0.2))),
               other = must(world.create_body(worldtest::ball({-1, 3, 0}, 0.2)));
  must(world.create_spring(spring_between(free, other, 0.5, 2000)));
}

}  // namespace

TEST_CASE("motor: turns two free bodies against each other, and neither momentum changes") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    Run run(mode, {}, 4);
    const BodyId a = rotor(run), b = rotor(run, {1, 0, 0});
    JointDef joint = hinge(a, b, {0.5, 0, 0}, {-0.5, 0, 0});
    joint.motor = {10, 0.1};
    must(run.world.create_joint(joint));
    run.step(1.0 / 60, 30);  // half a second: each takes 0.1 N m
    const double tolerance = mode.is_double() ? 1e-9 : 2e-3;
    CHECK(run.world.angular_velocity(b)->x == doctest::Approx(0.1 / inertia * 0.5).epsilon(tolerance));
    CHECK(run.world.angular_velocity(a)->x == doctest::Approx(-0.1 / inertia * 0.5).epsilon(tolerance));
    run.step(1.0 / 60, 60);
    CHECK(run.world.angular_velocity(b)->x - run.world.angular_velocity(a)->x == doctest::Approx(10).epsilon(1e-5));
    CHECK(length(run.world.angular_momentum()) <= (mode.is_double() ? 1e-14 : 1e-6));
    CHECK(length(run.world.momentum()) <= (mode.is_double() ? 1e-14 : 1e-6));
  }
}

TEST_CASE("motor: a brake holds a pendulum while its torque suffices, and may be let go") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Run run(mode, {0, 0, -gravity}, 4);
    const BodyId bob = rotor(run, {0, 1, 0});
    JointDef joint = hinge(run.world.ground(), bob, {}, {0, -1, 0});
    joint.motor = {0, 1.5 * gravity};
    const JointId id = must(run.world.create_joint(joint));
    run.step(1.0 / 60, 60);
    CHECK(std::fabs(run.position(bob).z) <= 1e-4);
    must(run.world.set_motor(id, {0, 0.5 * gravity}));  // half of what it takes
    run.step(1.0 / 60, 15);
    CHECK(run.position(bob).z < -0.05);
    must(run.world.set_motor(id, {}));
    CHECK(run.world.joint(id)->motor.torque == 0);
    run.step(1.0 / 60, 30);
    CHECK(run.position(bob).z < -0.5);
  }
}

TEST_CASE("motor: an angle limit stops it") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Run run(mode, {}, 4);
    const BodyId body = rotor(run);
    JointDef joint = hinge(run.world.ground(), body);
    joint.freedom = AngleFreedom::hinge(-1, 1);
    joint.motor = {5, 0.5};
    must(run.world.create_joint(joint));
    run.step(1.0 / 60, 120);
    const Quat q = run.orientation(body);
    CHECK(2 * std::atan2(q.x, q.w) == doctest::Approx(1).epsilon(1e-2));
    CHECK(length(*run.world.angular_velocity(body)) <= 1e-2);
  }
}

TEST_CASE("angular spring: the period and decay of a torsion pendulum; an orientation of rest") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    Run run(mode, {}, 4);
    const BodyId body = rotor(run);
    JointDef joint = hinge(run.world.ground(), body);
    joint.freedom = {};  // a ball joint
    const Vec3 rest{0.3, -0.2, 0.4};
    joint.spring = {2, 0.01, exponential(rest)};
    must(run.world.create_joint(joint));
    const double w = std::sqrt(2 / inertia), d = 0.01 / inertia / 2, w1 = std::sqrt(w * w - d * d);
    for (int k = 1; k <= 240; k++) {
      run.step(1.0 / 240);
      const double t = k / 240.0, share = 1 - std::exp(-d * t) * (std::cos(w1 * t) + d / w1 * std::sin(w1 * t));
      CHECK(angle_between(run.orientation(body), exponential(share * rest)) <= 1e-4);
    }
  }
}

// Its spin about itself no sub-step could resolve; the swing goes by a formula of its own order all the same.
TEST_CASE("angular spring: what only damps brakes a thin rod as exp(-c t / I), about each axis by itself") {
  for (const Mode& mode : everywhere())
    for (const AngleFreedom& freedom : {AngleFreedom{}, AngleFreedom::cone_and_twist(2, 2)}) {
      CAPTURE(mode.name());
      Run run(mode, {}, 4);
      BodyDef def = free_body(1, {0.05, 0.05, 1e-6});
      def.angular_velocity = {0, 3, 0};
      const BodyId body = run.add(def);
      JointDef joint;
      joint.a = run.world.ground(), joint.b = body;
      joint.freedom = freedom;
      joint.spring.damping = 0.1;
      must(run.world.create_joint(joint));
      for (int k = 1; k <= 60; k++) {
        run.step(1.0 / 60);
        const double turned = 1.5 * (1 - std::exp(-2 * k / 60.0));
        CHECK(angle_between(run.orientation(body), exponential({0, turned, 0})) <= 2e-5);
      }
    }
}

TEST_CASE("angular spring: of any stiffness, makes no energy and comes to rest") {
  for (const Mode& mode : precisions())
    for (double stiffness : {1e3, 1e6, 1e12}) {
      CAPTURE(mode.name());
      CAPTURE(stiffness);
      Run run(mode, {}, 4);
      BodyId before = run.world.ground();
      for (int i = 0; i < 6; i++) {
        const BodyId link = rotor(run, {0.5 * i + 0.25, 0, 0});
        JointDef joint = hinge(before, link, i == 0 ? Vec3{} : Vec3{0.25, 0, 0}, {-0.25, 0, 0});
        joint.freedom = {};
        joint.spring = {stiffness, 0, axis_angle({0, 0, 1}, 0.1)};
        must(run.world.create_joint(joint));
        before = link;
      }
      const double start = total_energy(run.world);
      for (int k = 0; k < 100; k++) {
        run.step(0.01);
        REQUIRE(total_energy(run.world) <= 1.01 * start);
      }
      if (stiffness > 1e4) CHECK(total_energy(run.world) <= 1e-3 * start);
    }
}

TEST_CASE("spring between points: hangs at its weight, by rows and inside a tree") {
  for (const Mode& mode : everywhere())
    for (double stiffness : {100.0, 1e5}) {
      CAPTURE(mode.name());
      CAPTURE(stiffness);
      Run run(mode, {0, 0, -gravity}, 4);
      SpringDef def = spring_between(run.world.ground(), {}, 1, stiffness);
      def.damping = 2 * std::sqrt(stiffness);
      const BodyId ball = rotor(run, {0, 0, -1}), link = rotor(run, {3, 0, -1}), end = rotor(run, {3, 0, -2});
      def.b = ball;
      must(run.world.create_spring(def));
      def.anchor_a = {3, 0, 0};
      def.b = link;
      must(run.world.create_spring(def));
      JointDef pin = hinge(link, end, {0, 0, -0.5}, {0, 0, 0.5});
      pin.freedom = {};
      must(run.world.create_joint(pin));
      run.step(1.0 / 60, 300);
      CHECK(run.position(ball).z == doctest::Approx(-1 - gravity / stiffness).epsilon(1e-5));
      CHECK(run.position(link).z == doctest::Approx(-1 - 2 * gravity / stiffness).epsilon(1e-5));
    }
}

TEST_CASE("spring between points: 1e6 N/m between light bodies that fly and spin makes no energy, keeps both momenta") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Run run(mode, {}, 4);
    std::vector<BodyId> balls;
    for (int i = 0; i < 3; i++) {
      BodyDef def = free_body(1e-2, {1e-5, 1e-5, 1e-5}, {0, 3.0 * (i - 1), 1});
      def.pose.position = {0.5 * i, 0.02 * i, 0};
      def.angular_velocity = {5, -3, 10};
      balls.push_back(run.add(def));
    }
    for (int i = 0; i < 2; i++) {
      SpringDef def = spring_between(balls[std::size_t(i)], balls[std::size_t(i) + 1], 0.45, 1e6);
      def.anchor_a = {0.02, 0.01, 0};
      must(run.world.create_spring(def));
    }
    const double start = total_energy(run.world);
    const Vec3 p = run.world.momentum(), l = run.world.angular_momentum();
    for (int k = 0; k < 300; k++) {
      run.step(0.01);
      REQUIRE(total_energy(run.world) <= 1.01 * start);
    }
    CHECK(length(run.world.momentum() - p) <= (mode.is_double() ? 1e-14 : 1e-6));
    CHECK(length(run.world.angular_momentum() - l) <= (mode.is_double() ? 1e-13 : 1e-5) * length(l));
  }
}

TEST_CASE("motors and springs: equal hashes on every lane width and on GL; repeatable from a snapshot") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    std::vector<std::uint64_t> hashes;
    for (const Mode& mode : everywhere()) {
      if (mode.precision != precision) continue;
      Run run(mode, {0, -gravity, 0}, 4);
      workshop(run.world);
      run.step(1.0 / 60, 30);
      const auto snapshot = run.world.snapshot();
      run.step(1.0 / 60, 30);
      hashes.push_back(run.world.hash());
      REQUIRE(run.world.restore(snapshot));
      run.step(1.0 / 60, 30);
      CHECK(run.world.hash() == hashes.back());
      for (BodyId id : run.world.bodies()) CHECK(length(run.position(id)) < 10);
    }
    for (const std::uint64_t hash : hashes) CHECK(hash == hashes.front());
  }
}

TEST_CASE("motors and springs: the plan holds their kernels where there are any, and says so where not") {
  const auto text = [](World& world) {
    Stepper stepper;
    return to_text(*stepper.plan_for(world, 1.0 / 60));
  };
  World world;
  workshop(world);
  for (const char* kernel :
       {"tree_drives", "tree_solve_driven", "joint_drives", "joint_solve_driven", "tree_joint_solve_driven"})
    CHECK(text(world).find(kernel) != std::string::npos);
  for (const JointId joint : world.joints()) {
    must(world.set_motor(joint, {}));
    must(world.set_spring(joint, AngularSpring{}));
  }
  for (const SpringId spring : world.springs()) must(world.destroy(spring));
  CHECK(text(world).find("driven") == std::string::npos);
  CHECK(text(world).find("left out: motors and springs, since no joint has any") != std::string::npos);
}

TEST_CASE("motors and springs: what is refused, and by which name") {
  World world;
  const BodyId a = must(world.create_body(worldtest::ball({0, 0, 0}))),
               b = must(world.create_body(worldtest::ball({2, 0, 0})));
  JointDef joint = hinge(a, b);
  const JointId id = must(world.create_joint(joint));
  const double bad = not_a_number;
  CHECK_REFUSED(world, world.set_motor(id, {bad, 1}), ErrorCode::not_finite, "speed of a motor");
  CHECK_REFUSED(world, world.set_motor(id, {1, -1}), ErrorCode::bad_joint, "torque of a motor");
  CHECK_REFUSED(world, world.set_motor(id, {1, infinite}), ErrorCode::not_finite, "torque of a motor");
  CHECK_REFUSED(world, world.set_spring(id, AngularSpring{-1, 0, {}}), ErrorCode::bad_joint,
                "stiffness of an angular spring");
  CHECK_REFUSED(world, world.set_spring(id, AngularSpring{1, bad, {}}), ErrorCode::not_finite,
                "damping of an angular spring");
  CHECK_REFUSED(world, world.set_spring(id, AngularSpring{1, 0, {0, 0, 0, 2}}), ErrorCode::not_unit_quaternion,
                "rest orientation");
  joint.motor.torque = -2;
  CHECK_REFUSED(world, world.create_joint(joint), ErrorCode::bad_joint, "torque of a motor");
  SpringDef spring = spring_between(a, b, 1, -5);
  CHECK_REFUSED(world, world.create_spring(spring), ErrorCode::bad_joint, "stiffness of a spring");
  spring.stiffness = bad;
  CHECK_REFUSED(world, world.create_spring(spring), ErrorCode::not_finite, "stiffness of a spring");
  spring = spring_between(a, b, -1, 5);
  CHECK_REFUSED(world, world.create_spring(spring), ErrorCode::bad_joint, "rest length of a spring");
  spring = spring_between(a, a, 1, 5);
  CHECK_REFUSED(world, world.create_spring(spring), ErrorCode::bad_joint, "two different bodies");
}

TEST_CASE("springs between points: ids of their own, which stale ones and those of joints are not") {
  World world;
  const BodyId a = must(world.create_body(worldtest::ball({0, 0, 0}))),
               b = must(world.create_body(worldtest::ball({2, 0, 0})));
  const SpringId spring = must(world.create_spring(spring_between(a, b, 1, 10)));
  const JointId joint = must(world.create_joint(hinge(a, b, {1, 0, 0}, {-1, 0, 0})));
  CHECK(world.springs() == std::vector{spring});
  CHECK(world.joints() == std::vector{joint});
  CHECK(world.joint_count() == 1);
  CHECK_FALSE(world.valid(worldtest::as_in(world, JointId{spring.index, spring.generation})));
  CHECK_FALSE(world.valid(worldtest::as_in(world, SpringId{joint.index, joint.generation})));
  CHECK(world.spring(spring)->stiffness == 10);
  must(world.set_spring(spring, 2, 20, 3));
  CHECK(world.spring(spring)->rest_length == 2);
  CHECK(world.spring_energy() == 0);
  must(world.destroy(spring));
  CHECK_REFUSED(world, world.set_spring(spring, 1, 1, 1), ErrorCode::stale_id, "no spring");
  const SpringId again = must(world.create_spring(spring_between(a, b, 1, 10)));
  must(world.destroy(a));
  CHECK_FALSE(world.valid(again));
  CHECK(world.springs().empty());
}
