// Pins: ids come from the sequence of create and destroy calls alone, smallest free index first, with a new
// generation; every function refuses a stale id with ErrorCode::stale_id; destroying a body moves rows about
// without anybody noticing, and takes shapes, joints, forces and exceptions from collision along.
#include <utility>

#include "support_world.h"
#include "world/state.h"

using namespace worldtest;

namespace {

World empty() { return World(WorldDef{Precision::f32, {0, 0, 0}}); }

/// Recognisable values, different for every n.
BodyDef numbered(int n) {
  BodyDef def = ball({10.0 * n, 0.25 * n, -1.0 * n}, 0.25 + 0.125 * n);
  def.velocity = {1.0 * n, 2.0 * n, 3.0 * n};
  def.linear_drag = 0.5 * n;
  def.material = {0.125 * n, 0.0625 * n, 0.03125 * n};
  return def;
}

void check_numbered(const World& world, BodyId id, int n) {
  const BodyDef def = numbered(n);
  CHECK(must(world.pose(id)).position == def.pose.position);
  CHECK(must(world.velocity(id)) == def.velocity);
  CHECK(must(world.material(id)).restitution == def.material.restitution);
  CHECK(must(world.shapes(id)).at(0).size == def.shapes[0].size);
  const std::uint32_t row = must(world.row_of(id));
  CHECK(must(world.view("linear_drag")).at(row) == def.linear_drag);
}

}  // namespace

TEST_CASE("ids: smallest free index first, and a new generation") {
  World world = empty();
  CHECK(world.ground() == as_in(world, BodyId{0, 1}));
  std::vector<BodyId> ids;
  for (int i = 0; i < 5; i++) ids.push_back(must(world.create_body(numbered(i))));
  for (std::uint32_t i = 0; i < 5; i++) CHECK(ids[i] == as_in(world, BodyId{i + 1, 1}));
  for (std::size_t i : {4, 1, 3}) must(world.destroy(ids[i]));
  CHECK(must(world.create_body(numbered(5))) == as_in(world, BodyId{2, 2}));
  CHECK(must(world.create_body(numbered(6))) == as_in(world, BodyId{4, 2}));
  CHECK(must(world.create_body(numbered(7))) == as_in(world, BodyId{5, 2}));
  CHECK(must(world.create_body(numbered(8))) == as_in(world, BodyId{6, 1}));
  const std::uint32_t here = world.ground().world;
  CHECK(world.bodies() ==
        std::vector<BodyId>{{1, 1, here}, {2, 2, here}, {3, 1, here}, {4, 2, here}, {5, 2, here}, {6, 1, here}});
  CHECK_FALSE(world.valid(ids[1]));
  CHECK(world.valid(as_in(world, BodyId{2, 2})));
  CHECK_FALSE(world.valid(BodyId{}));
  CHECK_FALSE(world.valid(as_in(world, BodyId{99, 1})));
}

TEST_CASE("ids: what happens in between, steps included, does not matter") {
  const auto sequence = [](bool busy) {
    World world = empty();
    Stepper stepper;
    std::vector<BodyId> ids;
    for (int i = 0; i < 12; i++) {
      ids.push_back(must(world.create_body(numbered(i))));
      if (busy) run(world, stepper, 1);
      if (busy) CHECK_FALSE(world.create_body(ball({}, -1)));
      if (i % 3 == 2) must(world.destroy(ids[std::size_t(i) - 1]));
      if (busy)
        CHECK_FALSE(world.create_ragdoll(
            [] {
              RagdollDef def = RagdollDef::human();
              def.bones.back().shape.size.x = -1;
              return def;
            }(),
            {}));
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
    for (const BodyId id : world.bodies()) all.emplace_back(id.index, id.generation);
    return all;
  };
  CHECK(sequence(false) == sequence(true));
}

TEST_CASE("ids: a refused ragdoll leaves indices, generations and shapes as they were") {
  const auto after = [](bool refused) {
    World world = empty();
    (void)must(world.create_body(numbered(1)));
    RagdollDef broken = RagdollDef::human();
    broken.bones.back().freedom = AngleFreedom::cone_and_twist(-1, 0);
    if (refused) CHECK_FALSE(world.create_ragdoll(broken, {}));
    const Ragdoll made = must(world.create_ragdoll(RagdollDef::human(), {{0, 3, 0}, {}}));
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
    must(world.set_gravity({0, -9.81, 0}));
    Stepper stepper;
    run(world, stepper, 90);
    CHECK(made.bones.front() == as_in(world, BodyId{2, 1}));
    CHECK(made.joints.front() == as_in(world, JointId{0, 1}));
    return world.hash();
  };
  CHECK(after(false) == after(true));
}

TEST_CASE("ids: of joints and forces") {
  World world = empty();
  const BodyId a = must(world.create_body(numbered(1))), b = must(world.create_body(numbered(2)));
  JointDef def;
  def.a = a;
  def.b = b;
  const JointId first = must(world.create_joint(def)), second = must(world.create_joint(def));
  CHECK(first == as_in(world, JointId{0, 1}));
  CHECK(second == as_in(world, JointId{1, 1}));
  must(world.destroy(first));
  CHECK(must(world.create_joint(def)) == as_in(world, JointId{0, 2}));
  CHECK(world.joints() == std::vector<JointId>{{0, 2, first.world}, {1, 1, first.world}});
  const ForceId f = must(world.add_force(a, Wrench{})), g = must(world.add_force(b, Wrench{}));
  CHECK(g.index == f.index + 1);
  must(world.remove(f));
  CHECK(must(world.add_force(b, Wrench{})) == as_in(world, ForceId{f.index, f.generation + 1}));
}

TEST_CASE("ids: a stale one is refused by every function") {
  World world = empty();
  const BodyId other = must(world.create_body(numbered(1))), gone = must(world.create_body(numbered(2)));
  JointDef def;
  def.a = other;
  def.b = gone;
  const JointId joint = must(world.create_joint(def));
  const ForceId force = must(world.add_force(gone, Wrench{{1, 0, 0}, {}}));
  must(world.destroy(gone));
  (void)must(world.create_body(numbered(3)));  // takes the index
  Stepper stepper;
  run(world, stepper, 1);  // functions of the last position need a step

  const ErrorCode code = ErrorCode::stale_id;
  const char* words = "This id names no body of the world: it was destroyed, or never created here.";
  for (BodyId id : {gone, BodyId{}, as_in(world, BodyId{77, 1})}) {
    CHECK_REFUSED(world, world.destroy(id), code, words);
    CHECK_REFUSED(world, world.pose(id), code, words);
    CHECK_REFUSED(world, world.set_pose(id, {}), code, words);
    CHECK_REFUSED(world, world.velocity(id), code, words);
    CHECK_REFUSED(world, world.set_velocity(id, {}), code, words);
    CHECK_REFUSED(world, world.angular_velocity(id), code, words);
    CHECK_REFUSED(world, world.set_angular_velocity(id, {}), code, words);
    CHECK_REFUSED(world, world.angular_momentum(id), code, words);
    CHECK_REFUSED(world, world.position_last(id), code, words);
    CHECK_REFUSED(world, world.set_position_last(id, {}), code, words);
    CHECK_REFUSED(world, world.orientation_last(id), code, words);
    CHECK_REFUSED(world, world.set_orientation_last(id, {}), code, words);
    CHECK_REFUSED(world, world.kind(id), code, words);
    CHECK_REFUSED(world, world.mass_properties(id), code, words);
    CHECK_REFUSED(world, world.set_mass_properties(id, {1, {1, 1, 1}}), code, words);
    CHECK_REFUSED(world, world.material(id), code, words);
    CHECK_REFUSED(world, world.set_material(id, {}), code, words);
    CHECK_REFUSED(world, world.set_drag(id, 0, 0), code, words);
    CHECK_REFUSED(world, world.add_force(id, Wrench{}), code, words);
    CHECK_REFUSED(world, world.add_force(id, [](const World&, BodyId) { return Wrench{}; }), code, words);
    CHECK_REFUSED(world, world.shapes(id), code, words);
    CHECK_REFUSED(world, world.set_filter(id, {}), code, words);
    CHECK_REFUSED(world, world.set_collide(id, other, false), code, words);
    CHECK_REFUSED(world, world.set_collide(other, id, true), code, words);
    CHECK_REFUSED(world, world.row_of(id), code, words);
    def.a = id;
    def.b = other;
    CHECK_REFUSED(world, world.create_joint(def), code, words);
    std::swap(def.a, def.b);
    CHECK_REFUSED(world, world.create_joint(def), code, words);
  }
  words = "This id names no joint of the world: it was destroyed, or never created here.";
  for (JointId id : {joint, JointId{}, as_in(world, JointId{77, 1})}) {
    CHECK_FALSE(world.valid(id));
    CHECK_REFUSED(world, world.destroy(id), code, words);
    CHECK_REFUSED(world, world.joint(id), code, words);
    CHECK_REFUSED(world, world.joint_separation(id), code, words);
  }
  words = "This id names no force of the world: it was destroyed, or never created here.";
  for (ForceId id : {force, ForceId{}, as_in(world, ForceId{77, 1})})
    CHECK_REFUSED(world, world.remove(id), code, words);
}

TEST_CASE("destroying bodies: the others keep their data, whatever row they move to") {
  World world = empty();
  std::vector<BodyId> ids;
  for (int i = 0; i < 10; i++) ids.push_back(must(world.create_body(numbered(i))));
  std::vector<bool> alive(10, true);
  for (std::size_t victim : {0, 9, 4, 5, 1, 8, 2}) {
    must(world.destroy(ids[victim]));
    alive[victim] = false;
    std::size_t count = 0;
    for (std::size_t i = 0; i < ids.size(); i++) {
      CHECK(world.valid(ids[i]) == alive[i]);
      if (!alive[i]) continue;
      count++;
      check_numbered(world, ids[i], int(i));
    }
    CHECK(world.body_count() == count);
  }
}

TEST_CASE("destroying joints: the others keep their data, whatever row they move to") {
  World world = empty();
  std::vector<BodyId> bodies;
  std::vector<JointId> joints;
  for (int i = 0; i < 6; i++) bodies.push_back(must(world.create_body(numbered(i))));
  for (std::size_t i = 0; i < 5; i++) {
    JointDef def;
    def.a = bodies[i];
    def.b = bodies[i + 1];
    def.frame_a.position = {double(i), 0, 0};
    joints.push_back(must(world.create_joint(def)));
  }
  must(world.destroy(joints[1]));
  must(world.destroy(joints[4]));
  for (std::size_t i : {0, 2, 3}) {
    CHECK(must(world.joint(joints[i])).a == bodies[i]);
    CHECK(must(world.joint(joints[i])).frame_a.position.x == double(i));
  }
  // the table's rows follow: what the kernels read is what the host gave
  const PropertyView anchors = must(world.view("anchor_a"));
  double sum = 0;
  for (std::size_t row = 1; row < anchors.count; row++) sum += anchors.at(row, 0);
  CHECK(anchors.count == 4);
  CHECK(sum == 0 + 2 + 3);
}

TEST_CASE("destroying a body takes its joints, forces, shapes and collision exceptions along") {
  World world = empty();
  const BodyId a = must(world.create_body(numbered(1))), b = must(world.create_body(numbered(2))),
               c = must(world.create_body(numbered(3)));
  JointDef def;
  def.a = a;
  def.b = b;
  const JointId ab = must(world.create_joint(def));
  def.a = c;
  def.b = a;
  const JointId ca = must(world.create_joint(def));
  def.b = b;
  const JointId cb = must(world.create_joint(def));
  const ForceId on_b = must(world.add_force(b, Wrench{{1, 0, 0}, {}})),
                on_c = must(world.add_force(c, Wrench{{2, 0, 0}, {}}));
  const ForceId callback = must(world.add_force(b, [](const World&, BodyId) { return Wrench{}; }));
  must(world.set_collide(a, b, false));
  must(world.destroy(b));
  CHECK_FALSE(world.valid(ab));
  CHECK_FALSE(world.valid(cb));
  CHECK(world.valid(ca));
  CHECK(world.joint_count() == 1);
  CHECK_FALSE(world.remove(on_b));
  CHECK_FALSE(world.remove(callback));
  CHECK(world.remove(on_c));
  CHECK(world.state().callbacks == 0);
  CHECK(world.state().no_collide.size() == 1);
  CHECK(world.state().free_shapes.size() == 1);
}

TEST_CASE("contacts of a destroyed body are gone: a newcomer in its place inherits no impulse") {
  const auto landed = [](bool predecessor) {
    World world;
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
    BodyId first = must(world.create_body(ball({0, predecessor ? 0.499 : 50, 0})));
    Stepper stepper;
    run(world, stepper, 30);
    CHECK(world.contact_count() == (predecessor ? 1 : 0));
    must(world.destroy(first));
    CHECK(world.contact_count() == 0);
    const BodyId second = must(world.create_body(ball({0, 0.499, 0})));
    run(world, stepper, 1);
    return must(world.velocity(second));
  };
  CHECK(landed(true) == landed(false));
}

TEST_CASE("the ground stands at the origin and stays") {
  World world;
  CHECK(must(world.kind(world.ground())) == BodyKind::fixed);
  CHECK(must(world.pose(world.ground())) == Pose{});
  CHECK(must(world.row_of(world.ground())) == 0);
  CHECK(world.body_count() == 0);
  CHECK(world.bodies().empty());
  CHECK_REFUSED(world, world.destroy(world.ground()), ErrorCode::bad_argument, "The ground cannot be destroyed.");
  CHECK_REFUSED(world, world.set_pose(world.ground(), {{1, 0, 0}, {}}), ErrorCode::bad_argument,
                "The ground stays at the origin; create a fixed body for anything else.");
  CHECK_REFUSED(world, world.set_velocity(world.ground(), {1, 0, 0}), ErrorCode::bad_argument,
                "A fixed body has no velocity");
  const BodyId body = must(world.create_body(ball({1, 2, 3})));
  JointDef def;
  def.a = world.ground();
  def.b = body;
  def.frame_a.position = {1, 2, 3};
  const JointId joint = must(world.create_joint(def));
  CHECK(must(world.joint_separation(joint)) == 0);
  Stepper stepper;
  run(world, stepper, 20);
  CHECK(must(world.joint_separation(joint)) < 1e-3);
  CHECK(must(world.pose(world.ground())) == Pose{});
}
