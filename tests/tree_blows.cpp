// Pins what hard blows do to bodies of joint trees: one that stands is not sent through the floor by what falls on it
// from its own tree, though it did not move itself (it was not looked for there, and a shin sank by its thickness), and
// one that lies wedged between two walls that overlap it is not pushed ever harder (its ragdoll's energy grew by half
// of what the whole heap had).
#include <algorithm>

#include "support_world.h"

using namespace worldtest;

namespace {

struct Pair {
  BodyId lower, upper;
};
/// Two balls of 5 cm, one 0.5 m above the other, pinned together at the upper one.
Pair pinned(World& world, Vec3 lower, double upper_mass) {
  BodyDef def = ball(lower, 0.05);
  def.mass = 1;
  const BodyId a = must(world.create_body(def));
  def.mass = upper_mass;
  def.pose.position.y += 0.5;
  const BodyId b = must(world.create_body(def));
  JointDef joint;
  joint.a = a;
  joint.b = b;
  joint.frame_a.position.y = 0.5;
  must(world.create_joint(joint));
  return {a, b};
}
double largest_impulse(const World& world) {
  double most = 0;
  for (const Contact& contact : world.contacts())
    for (const Contact::Point& point : contact.points) most = std::max(most, point.impulse);
  return most;
}

}  // namespace

TEST_CASE("what falls on a foot from its own tree does not send it through the floor") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const double speed : {5.0, 12.0, 20.0}) {
      CAPTURE(speed);
      World world({precision});
      must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
      const Pair tree = pinned(world, {0, 0.07, 0}, 20);  // 2 cm above the floor
      must(world.set_velocity(tree.upper, {0, -speed, 0}));
      Stepper stepper;
      double lowest = 1;
      for (int i = 0; i < 30; i++) {
        run(world, stepper, 1);
        lowest = std::min(lowest, must(world.pose(tree.lower)).position.y);
      }
      MESSAGE("sent down at " << speed << " m/s: " << (lowest - 0.05) * 1000 << " mm from the floor at the lowest");
      CHECK(lowest > 0.04);
    }
}

TEST_CASE("what is wedged between two walls is not pushed ever harder") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({precision});
    must(world.create_body(fixed_box({0, -0.5, 0}, {1, 0.5, 1})));
    must(world.create_body(fixed_box({0, 0.54, 0}, {0.2, 0.5, 0.2})));  // 4 cm above the floor; the ball is 10 cm thick
    const Pair tree = pinned(world, {0, 0.02, 0}, 5);
    for (const BodyId wall : {world.bodies()[1]}) must(world.set_collide(wall, tree.upper, false));
    Stepper stepper;
    run(world, stepper, 120);
    const double early = largest_impulse(world);
    run(world, stepper, 1200);
    const double late = largest_impulse(world);
    MESSAGE("largest impulse after 2 and 22 s: " << early << ", " << late << " N s; kinetic energy "
                                                 << world.kinetic_energy() << " J");
    CHECK(early > 0);
    CHECK(late <= 1.01 * early);
    CHECK(late <= 100);  // what a wall holds and what its overlap pushes
    CHECK(world.kinetic_energy() < 1);
  }
}
