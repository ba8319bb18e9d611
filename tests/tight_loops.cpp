// Pins what loops of joints do that cannot move without pulling hard: bridges built straight on two pins, and nets that
// hang by two corners. No energy is made, and pins stay closed. Bridges of 40 planks once gained 1e5 J, nets of 4 x 4
// balls 200 times the energy of their fall.
#include <algorithm>
#include <string>

#include "support_world.h"

using namespace worldtest;

namespace {

JointId pin(World& world, BodyId a, BodyId b, Vec3 at) {
  JointDef joint;
  joint.a = a;
  joint.b = b;
  const auto local = [&](BodyId id) {
    if (id == world.ground()) return at;
    const Pose pose = *world.pose(id);
    return rotate(conjugate(pose.orientation), at - pose.position);
  };
  joint.frame_a.position = local(a);
  joint.frame_b.position = local(b);
  return must(world.create_joint(joint));
}

void add_straight_bridge(World& world, int planks) {
  BodyId before = world.ground();
  for (int i = 0; i < planks; i++) {
    BodyDef def = fixed_box({0.5 * i + 0.25, 0, 0}, {0.24, 0.05, 0.5});
    def.kind = BodyKind::dynamic;
    def.mass = 10;
    const BodyId plank = must(world.create_body(def));
    (void)pin(world, before, plank, {0.5 * i, 0, 0});
    before = plank;
  }
  (void)pin(world, before, world.ground(), {0.5 * planks, 0, 0});
}

/// Balls of 1 kg pinned to their neighbours half way, the corners of one side to the ground.
void add_net(World& world, int wide, double radius) {
  const double pitch = 0.3;
  std::vector<BodyId> balls;
  for (int i = 0; i < wide * wide; i++) {
    BodyDef def = ball({pitch * (i % wide), 0, pitch * (i / wide)}, radius);
    def.mass = 1;
    balls.push_back(must(world.create_body(def)));
  }
  const auto place = [&](int i) { return Vec3{pitch * (i % wide), 0, pitch * (i / wide)}; };
  for (int i = 0; i < wide * wide; i++) {
    if (i % wide + 1 < wide)
      (void)pin(world, balls[std::size_t(i)], balls[std::size_t(i + 1)], 0.5 * (place(i) + place(i + 1)));
    if (i + wide < wide * wide)
      (void)pin(world, balls[std::size_t(i)], balls[std::size_t(i + wide)], 0.5 * (place(i) + place(i + wide)));
  }
  for (const int corner : {0, wide - 1}) (void)pin(world, world.ground(), balls[std::size_t(corner)], place(corner));
}

double energy(const World& world) { return world.kinetic_energy() + world.potential_energy(); }

/// Most that energy was above that of the start, over how far the potential energy fell; and the widest gap [m].
struct Fall {
  double gain, gap;
};
Fall fall(World& world, double dt, double seconds) {
  Stepper stepper;
  const double start = energy(world);
  double most = 0, lowest = 0, gap = 0;
  for (int i = 0; i < seconds / dt; i++) {
    const StepReport& report = stepper.step(world, dt);
    REQUIRE(report);
    CHECK(report.frozen.empty());
    most = std::max(most, energy(world) - start);
    lowest = std::min(lowest, world.potential_energy());
    for (const JointId joint : world.joints()) gap = std::max(gap, *world.joint_separation(joint));
  }
  return {most / -lowest, gap};
}

void check_fall(World& world, double dt, double most_gain, double most_gap, const std::string& what) {
  const Fall f = fall(world, dt, 2);
  MESSAGE(what << ": energy above the start " << f.gain << " of the fall, gap " << f.gap);
  CHECK(f.gain <= most_gain);
  CHECK(f.gap <= most_gap);
}

}  // namespace

TEST_CASE("tight loops: bridges built straight on two pins make no energy") {
  for (const int planks : {10, 40, 100})
    for (const double dt : {1 / 60.0, 1 / 240.0}) {
      World world;
      add_straight_bridge(world, planks);
      check_fall(world, dt, 1e-3, 0.01, "a bridge of " + std::to_string(planks) + ", dt " + std::to_string(dt));
    }
}

TEST_CASE("tight loops: nets of pins that hang by two corners make no energy") {
  for (const int wide : {3, 4, 6})
    for (const double radius : {0.05, 0.15}) {
      World world;
      add_net(world, wide, radius);
      check_fall(world, frame, 1e-3, 0.01,
                 "a net " + std::to_string(wide) + " wide of balls of " + std::to_string(radius));
    }
}

TEST_CASE("tight loops: a net too large for its trees makes little energy") {
  World world;
  add_net(world, 14, 0.05);
  Stepper stepper;
  CHECK(stepper.step(world, frame).joints_as_rows > 0);
  check_fall(world, frame, 0.05, 0.05, "a net 14 wide");
}

// A spring pulls as its law says, however hard: what swings in it gets the sub-steps. A bound of the pull let loads of
// 100 kg fall; without the sub-steps 1,000 kg gained 3.4 kJ, and 10,000 kg flew at 3e14 m/s.
TEST_CASE("tight loops: a load on a spring at the end of a light arm hangs there, and makes no energy") {
  for (const double load : {10.0, 100.0, 1e3, 1e4}) {
    World world;
    BodyDef def = fixed_box({0.25, 0, 0}, {0.25, 0.05, 0.05});
    def.kind = BodyKind::dynamic;
    def.mass = 1;
    const BodyId arm = must(world.create_body(def));
    (void)pin(world, world.ground(), arm, {});
    def = ball({0.5, -1.5, 0}, 0.3);
    def.mass = load;
    def.shapes[0].filter.mask = 0;
    const BodyId hung = must(world.create_body(def));
    SpringDef spring;
    spring.a = arm;
    spring.b = hung;
    spring.anchor_a = {0.25, 0, 0};
    spring.anchor_b = {0, 0.3, 0};
    spring.rest_length = 1.2;
    spring.stiffness = 1000 * load;
    spring.damping = 20 * load;
    (void)must(world.create_spring(spring));
    Stepper stepper;
    const double start = energy(world) + world.spring_energy();
    double most = 0;
    for (int i = 0; i < 600; i++) {
      REQUIRE(stepper.step(world, frame));
      most = std::max(most, energy(world) + world.spring_energy() - start);
    }
    CAPTURE(load);
    MESSAGE("a load of " << load << " kg: energy above the start " << most << " J, at " << world.pose(hung)->position.y
                         << " m");
    CHECK(most <= 1e-3 * load * 9.81);
    CHECK(world.pose(hung)->position.y >= -2.05);
  }
}
