// Pins who may touch whom: category and mask both ways, groups that override them, bodies that a joint
// connects (unless it says collide), exceptions of single pairs, and that bodies that cannot move ignore each other.
#include "support_world.h"

using namespace worldtest;

namespace {

/// Two balls that overlap, in free space; `prepare` sets them up. Answers whether a step makes a contact.
template <class Prepare>
bool touch(Prepare&& prepare, BodyKind kind_a = BodyKind::dynamic, BodyKind kind_b = BodyKind::dynamic) {
  World world(WorldDef{Precision::f32, {}});
  BodyDef def = ball({0, 0, 0});
  def.kind = kind_a;
  const BodyId a = must(world.create_body(def));
  def = ball({0.9, 0, 0});
  def.kind = kind_b;
  const BodyId b = must(world.create_body(def));
  prepare(world, a, b);
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(stepper.plan().substeps == 4);
  return world.contact_count() == 1;
}

bool with_filters(Filter a, Filter b) {
  return touch([&](World& world, BodyId x, BodyId y) {
    must(world.set_filter(x, a));
    must(world.set_filter(y, b));
  });
}

JointDef joint_between(BodyId a, BodyId b, bool collide = false) {
  JointDef def;
  def.a = a;
  def.b = b;
  def.frame_a.position = {0.45, 0, 0};
  def.frame_b.position = {-0.45, 0, 0};
  def.collide = collide;
  return def;
}

}  // namespace

TEST_CASE("filters: category and mask must agree both ways") {
  CHECK(with_filters({}, {}));
  CHECK(with_filters({1, 2, 0}, {2, 1, 0}));
  CHECK_FALSE(with_filters({1, 1, 0}, {2, 1, 0}));  // a does not want b
  CHECK_FALSE(with_filters({1, 2, 0}, {2, 2, 0}));  // b does not want a
  CHECK(with_filters({6, 8, 0}, {8, 4, 0}));        // one common bit is enough
  CHECK_FALSE(with_filters({0, 0xffffffffu, 0}, {1, 0xffffffffu, 0}));
  CHECK_FALSE(with_filters({1, 0, 0}, {1, 0xffffffffu, 0}));
}

TEST_CASE("filters: a common group decides alone") {
  CHECK_FALSE(with_filters({1, 1, -3}, {1, 1, -3}));
  CHECK(with_filters({1, 0, 3}, {1, 0, 3}));
  CHECK(with_filters({1, 1, -3}, {1, 1, -4}));
  CHECK(with_filters({1, 1, 3}, {1, 1, -3}));
  CHECK_FALSE(with_filters({1, 2, 3}, {1, 2, 4}));
  CHECK_FALSE(with_filters({1, 0, -3}, {1, 1, -3}));
}

TEST_CASE("filters: of a shape's definition count from the start") {
  World world(WorldDef{Precision::f32, {}});
  BodyDef def = ball({});
  def.shapes[0].filter = {1, 0xffffffffu, -1};
  (void)must(world.create_body(def));
  def.pose.position.x = 0.9;
  const BodyId b = must(world.create_body(def));
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(world.contact_count() == 0);
  must(world.set_filter(b, {}));
  CHECK(must(world.shapes(b))[0].filter.group == 0);
  run(world, stepper, 1);
  CHECK(world.contact_count() == 1);
}

TEST_CASE("bodies that a joint connects do not touch, unless it says so") {
  CHECK_FALSE(touch([](World& world, BodyId a, BodyId b) { (void)must(world.create_joint(joint_between(a, b))); }));
  CHECK(touch([](World& world, BodyId a, BodyId b) { (void)must(world.create_joint(joint_between(a, b, true))); }));
  // one joint that forbids is enough; with it gone they touch again
  const auto two = [](bool destroy_it) {
    return touch([&](World& world, BodyId a, BodyId b) {
      (void)must(world.create_joint(joint_between(a, b, true)));
      const JointId quiet = must(world.create_joint(joint_between(b, a)));
      if (destroy_it) must(world.destroy(quiet));
    });
  };
  CHECK_FALSE(two(false));
  CHECK(two(true));
  // two that forbid: both must go
  CHECK_FALSE(touch([](World& world, BodyId a, BodyId b) {
    const JointId first = must(world.create_joint(joint_between(a, b)));
    (void)must(world.create_joint(joint_between(a, b)));
    must(world.destroy(first));
  }));
}

TEST_CASE("exceptions of single pairs") {
  CHECK_FALSE(touch([](World& world, BodyId a, BodyId b) { must(world.set_collide(a, b, false)); }));
  CHECK_FALSE(touch([](World& world, BodyId a, BodyId b) { must(world.set_collide(b, a, false)); }));
  CHECK(touch([](World& world, BodyId a, BodyId b) {
    must(world.set_collide(a, b, false));
    must(world.set_collide(b, a, true));
  }));
}

TEST_CASE("exceptions of a body with others near and far in order of their ids") {
  World world(WorldDef{Precision::f32, {}});
  std::vector<BodyId> balls;  // all at one place, so that every two touch
  for (int i = 0; i < 130; i++) balls.push_back(must(world.create_body(ball({0.001 * i, 0, 0}))));
  for (const BodyId id : balls) must(world.set_filter(id, {1, 2, 0}));
  must(world.set_filter(balls[60], {2, 1, 0}));  // it alone meets the others
  const auto met = [&] {
    Stepper stepper;
    run(world, stepper, 1);
    return world.contact_count();
  };
  CHECK(met() == 129);
  for (const int other : {0, 59, 61, 100}) must(world.set_collide(balls[60], balls[std::size_t(other)], false));
  CHECK(met() == 125);
  for (const int other : {0, 100}) must(world.set_collide(balls[std::size_t(other)], balls[60], true));
  CHECK(met() == 127);
}

TEST_CASE("exceptions stand beside joints: neither undoes the other") {
  CHECK_FALSE(touch([](World& world, BodyId a, BodyId b) {
    (void)must(world.create_joint(joint_between(a, b)));
    must(world.set_collide(a, b, true));
  }));
  CHECK_FALSE(touch([](World& world, BodyId a, BodyId b) {
    must(world.set_collide(a, b, false));
    must(world.destroy(must(world.create_joint(joint_between(a, b)))));
  }));
  CHECK(touch([](World& world, BodyId a, BodyId b) {
    must(world.set_collide(a, b, false));
    must(world.set_collide(a, b, false));
    must(world.set_collide(a, b, true));
  }));
}

TEST_CASE("kinds: two bodies touch when one of them is dynamic") {
  const auto nothing = [](World&, BodyId, BodyId) {};
  CHECK(touch(nothing, BodyKind::dynamic, BodyKind::fixed));
  CHECK(touch(nothing, BodyKind::kinematic, BodyKind::dynamic));
  CHECK_FALSE(touch(nothing, BodyKind::kinematic, BodyKind::fixed));
  CHECK_FALSE(touch(nothing, BodyKind::fixed, BodyKind::fixed));
  CHECK_FALSE(touch(nothing, BodyKind::kinematic, BodyKind::kinematic));
}

TEST_CASE("adjacent bones do not touch, others do") {
  World world(WorldDef{Precision::f32, {}});
  const Ragdoll made = must(world.create_ragdoll(RagdollDef::human(), {{0, 3, 0}, {}}));
  CHECK(made.bones.size() == 12);
  CHECK(made.joints.size() == 11);
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(world.contact_count() == 0);  // the default pose overlaps at joints only
  // the two shins, brought together
  Pose shin = must(world.pose(made.bones[11]));
  shin.position.x += 0.01;
  must(world.set_pose(made.bones[10], shin));
  run(world, stepper, 1);
  CHECK(world.contact_count() > 0);
}

TEST_CASE("joints that come and go leave the pairs that a new stepper finds") {
  const auto after = [](bool anew) {
    SceneWorld s = scene_world("balls", 150);
    auto stepper = std::make_unique<Stepper>();
    run(s.world, *stepper, 90);
    std::vector<JointId> joints;
    std::uint32_t lot = 1;
    for (int i = 0; i < 60; i++) {
      const auto pick = [&] { return s.scene.bodies[(lot = lot * 1664525u + 1013904223u) / 65536 % 150].id; };
      const BodyId a = pick(), b = pick();
      if (a != b) joints.push_back(must(s.world.create_joint(joint_between(a, b))));
      if (i % 3 == 2) {
        must(s.world.destroy(joints.front()));
        joints.erase(joints.begin());
      }
      if (anew) stepper = std::make_unique<Stepper>();
      run(s.world, *stepper, 1);
    }
    return s.world.hash();
  };
  CHECK(after(false) == after(true));
}

TEST_CASE("a body and itself: refused by name") {
  World world;
  BodyDef def = ball({});
  const BodyId body = must(world.create_body(def));
  def.kind = BodyKind::kinematic;
  const BodyId hand = must(world.create_body(def));
  for (const bool collide : {false, true})
    CHECK_REFUSED(world, world.set_collide(body, body, collide), ErrorCode::bad_argument, "needs two different bodies");
  SpringDef spring;
  spring.a = spring.b = body;
  CHECK_REFUSED(world, world.create_spring(spring), ErrorCode::bad_joint, "A spring needs two different bodies");
  CHECK_REFUSED(world, world.create_joint(joint_between(body, body)), ErrorCode::bad_joint,
                "A joint needs two different bodies");
  for (const BodyId both : {body, hand})
    CHECK_REFUSED(world, world.grab(both, both, {}), ErrorCode::bad_joint, "A hand that grabs is a kinematic body");
}
