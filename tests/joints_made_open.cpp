// Joints that the host makes far open, or far beyond their limits, on bodies that move or rest: as where a ragdoll
// takes over from an animation. They close by places alone, so no energy is made.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support_world.h"
#include "wild/dice.h"

using namespace worldtest;

namespace {

enum class Freedom { ball, cone, hinge };

using wild::Dice;

Vec3 random_vector(Dice& dice, double most) {
  return {dice.between(-most, most), dice.between(-most, most), dice.between(-most, most)};
}

struct Scene {
  Freedom freedom = Freedom::ball;
  int bodies = 2;
  bool moves = false, closed = false;
  Precision precision = Precision::f64;
};

AngleFreedom freedom_of(Freedom kind, Dice& dice) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  AngleFreedom freedom;
  if (kind == Freedom::cone) {
    freedom.kind = AngleFreedom::Kind::cone_twist;
    freedom.cone = dice.between(0.05, 1);
    freedom.twist = dice.between(0.05, 1);
  }
  if (kind == Freedom::hinge) {
    freedom.kind = AngleFreedom::Kind::pitch_yaw_roll;
    freedom.lower = {-infinity, 0, 0};
    freedom.upper = {infinity, 0, 0};
  }
  return freedom;
}

/// A chain of boxes that touch nothing, anywhere within 2 m of each other.
void build(World& world, const Scene& scene, unsigned seed) {
  Dice dice("joints made open", seed);
  std::vector<BodyId> made;
  for (int i = 0; i < scene.bodies; i++) {
    BodyDef def;
    def.pose = {random_vector(dice, 1), dice.orientation()};
    if (scene.moves) {
      def.velocity = random_vector(dice, 1);
      def.angular_velocity = random_vector(dice, 5);
    }
    const double size = dice.by_ratio(0.03, 0.37);
    def.shapes = {ShapeDef::box({size, size * dice.between(0.2, 1), size})};
    def.shapes[0].filter.mask = 0;
    made.push_back(must(world.create_body(def)));
  }
  for (int i = 1; i < scene.bodies; i++) {
    JointDef def;
    def.a = made[std::size_t(i - 1)];
    def.b = made[std::size_t(i)];
    def.frame_a.position = random_vector(dice, 0.1);
    def.frame_b.position = random_vector(dice, 0.1);
    def.freedom = freedom_of(scene.freedom, dice);
    if (scene.closed) {
      const Pose a = must(world.pose(def.a));
      Pose b = must(world.pose(def.b));
      b.position =
          a.position + rotate(a.orientation, def.frame_a.position) - rotate(b.orientation, def.frame_b.position);
      must(world.set_pose(def.b, b));
    }
    (void)must(world.create_joint(def));
  }
}

/// Of two seconds, the most kinetic energy above the start's, by the mass [J/kg].
double most_gained(const Scene& scene, unsigned seed) {
  World world(WorldDef{.precision = scene.precision, .gravity = {}});
  build(world, scene, seed);
  Stepper stepper;
  const double start = world.kinetic_energy();
  double most = 0, mass = 0;
  for (int i = 0; i < 120; i++) {
    REQUIRE(stepper.step(world, 1.0 / 60));
    most = std::max(most, world.kinetic_energy() - start);
  }
  for (const BodyId id : world.bodies()) mass += must(world.mass_properties(id)).mass;
  return most / mass;
}

/// Of 100 scenes the worst, and how many gain more than `much`.
struct Gains {
  double worst = 0;
  int above = 0;
};
Gains of_all(const Scene& scene, double much) {
  Gains gains;
  for (unsigned seed = 1; seed <= 100; seed++) {
    const double gained = most_gained(scene, seed);
    gains.worst = std::max(gains.worst, gained);
    gains.above += gained > much;
  }
  return gains;
}

}  // namespace

TEST_CASE(
    "joints made open: chains that move and stand open by metres, beyond their limits, close and make no energy") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const Freedom freedom : {Freedom::ball, Freedom::cone, Freedom::hinge})
      for (const int bodies : {2, 3}) {
        const Gains gains = of_all({.freedom = freedom, .bodies = bodies, .moves = true, .precision = precision}, 0.1);
        MESSAGE("freedom " << int(freedom) << ", " << bodies << " bodies: the worst of 100 gains " << gains.worst
                           << " J/kg, " << gains.above << " more than 0.1");
        CHECK(gains.worst <= 1);
        CHECK(gains.above <= 5);
      }
}

TEST_CASE("joints made open: closed chains that rest beyond their limits turn back and make no energy") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const Freedom freedom : {Freedom::cone, Freedom::hinge})
      for (const int bodies : {2, 3, 8}) {
        if (freedom == Freedom::hinge && bodies == 8) continue;  // see docs/joint-trees.md, "What the host opens"
        const Gains gains = of_all({.freedom = freedom, .bodies = bodies, .closed = true, .precision = precision}, 0.3);
        MESSAGE("freedom " << int(freedom) << ", " << bodies << " bodies: the worst of 100 gains " << gains.worst
                           << " J/kg, " << gains.above << " more than 0.3");
        CHECK(gains.worst <= 1);
        CHECK(gains.above <= 5);
      }
}

// What is pushed turns, and its centre stays: a push that moves no centre is taken back as well.
TEST_CASE("joints made open: bodies pinned at their centres turn into line and have no motion of it at any step") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({precision, {0, 0, 0}});
    BodyId held = world.ground();
    for (const double turned : {0.0, 1.0}) {
      BodyDef def;
      def.pose.orientation = axis_angle({0, 0, 1}, turned);
      def.shapes = {ShapeDef::box({0.2, 0.1, 0.1})};
      const BodyId body = must(world.create_body(def));
      JointDef joint;
      joint.a = held;
      joint.b = body;
      if (turned > 0) joint.freedom.kind = AngleFreedom::Kind::pitch_yaw_roll;  // all three are locked
      must(world.create_joint(joint));
      held = body;
    }
    Stepper stepper;
    double most = 0;
    for (int i = 0; i < 60; i++) {
      run(world, stepper, 1);
      most = std::max(most, world.kinetic_energy());
    }
    CHECK(most < 1e-6);
    CHECK(must(world.pose(held)).orientation.z == doctest::Approx(std::sin(0.25)).epsilon(1e-4));  // both by half
  }
}
