// Pins what plain misuse gives: an error that names it, and where no error can, an end of the process with a sentence;
// never a memory error.
#include <functional>
#include <stdexcept>

#include "support_last_words.h"
#include "support_world.h"
#include "world/id_pool.h"

using namespace worldtest;

namespace {

struct Objects {
  World world;
  BodyId a, b, hand;
  JointId joint;
  SpringId spring;
  ForceId force;
  TableId table;
  Property<Real> heat;

  Objects() {
    a = must(world.create_body(ball({0, 0, 0})));
    b = must(world.create_body(ball({2, 0, 0})));
    BodyDef def;
    def.kind = BodyKind::kinematic;
    hand = must(world.create_body(def));
    JointDef pin;
    pin.a = a;
    pin.b = b;
    pin.frame_a.position = {1, 0, 0};
    pin.frame_b.position = {-1, 0, 0};
    joint = must(world.create_joint(pin));
    SpringDef pull;
    pull.a = a;
    pull.b = b;
    pull.stiffness = 1;
    spring = must(world.create_spring(pull));
    force = must(world.add_force(a, Wrench{}));
    table = must(world.add_table("rooms", 3));
    heat = must(world.add_property<Real>("heat"));
  }
};

template <class T> ErrorCode code(const Result<T>& result) { return result ? ErrorCode::none : result.error().code; }

/// What each function that changes a world answers, of a world for ids that may be of another.
std::vector<ErrorCode> change_all(World& world, const Objects& of) {
  JointDef pin;
  pin.a = of.a;
  pin.b = of.b;
  SpringDef pull;
  pull.a = of.a;
  pull.b = of.b;
  const ForceCallback nothing = [](const World&, BodyId) { return Wrench{}; };
  return {code(world.create_joint(pin)),
          code(world.create_spring(pull)),
          code(world.grab(of.hand, of.a, {})),
          code(world.destroy(of.a)),
          code(world.destroy(of.joint)),
          code(world.destroy(of.spring)),
          code(world.set_pose(of.a, {})),
          code(world.set_velocity(of.a, {})),
          code(world.set_angular_velocity(of.a, {})),
          code(world.set_position_last(of.a, {})),
          code(world.set_orientation_last(of.a, {})),
          code(world.wake(of.a)),
          code(world.set_can_sleep(of.a, true)),
          code(world.set_mass_properties(of.a, {1, {1, 1, 1}})),
          code(world.set_material(of.a, {})),
          code(world.set_drag(of.a, 0, 0)),
          code(world.add_force(of.a, Wrench{})),
          code(world.add_force(of.a, nothing)),
          code(world.remove(of.force)),
          code(world.set_filter(of.a, {})),
          code(world.set_collide(of.a, of.b, false)),
          code(world.set_motor(of.joint, {})),
          code(world.set_spring(of.joint, {})),
          code(world.set_spring(of.spring, 1, 1, 1)),
          code(world.add_property<Real>("more", 0, "1", of.table)),
          code(world.set(of.heat, of.a, Real(1))),
          code(world.resize(of.table, 2)),
          code(world.remove(of.table))};
}
/// And those that need no id.
std::vector<ErrorCode> change_without_ids(World& world) {
  return {code(world.create_body(ball({0, 9, 0}))),
          code(world.create_ragdoll(RagdollDef::human(), {})),
          code(world.set_gravity({})),
          code(world.add_property<Real>("other")),
          code(world.remove_property("heat")),
          code(world.add_table("more")),
          code(world.restore({}))};
}

}  // namespace

TEST_CASE("misuse: an id of another world names nothing") {
  Objects here, there;
  CHECK(here.a.index == there.a.index);
  CHECK(here.a.generation == there.a.generation);
  CHECK(here.a != there.a);
  const std::uint64_t before = here.world.hash();
  for (const ErrorCode answer : change_all(here.world, there)) CHECK(answer == ErrorCode::stale_id);
  CHECK(here.world.hash() == before);
  for (const ErrorCode answer :
       {code(here.world.pose(there.a)), code(here.world.velocity(there.a)), code(here.world.kind(there.a)),
        code(here.world.joint(there.joint)), code(here.world.spring(there.spring)), code(here.world.row_of(there.a)),
        code(here.world.rows(there.table)), code(here.world.get(there.heat, here.a)),
        code(here.world.get(here.heat, there.a))})
    CHECK(answer == ErrorCode::stale_id);
}

TEST_CASE("misuse: an index whose generations are used up names nothing new") {
  IdPool pool;
  BodyId id = pool.id<BodyId>(pool.allocate(0));
  pool.set_generation(id.index, IdPool::last_generation);
  id = pool.id<BodyId>(id.index);
  CHECK(pool.valid(id));
  pool.release(id.index);
  CHECK_FALSE(pool.valid(id));
  const BodyId next = pool.id<BodyId>(pool.allocate(0));
  CHECK(next.index != id.index);
  CHECK_FALSE(pool.valid(BodyId{}));
}

TEST_CASE("misuse: a callback sees a world that it cannot change") {
  Objects o;
  Stepper stepper, other;
  std::vector<ErrorCode> answers;
  (void)must(o.world.add_force(o.a, [&](const World&, BodyId) {
    const auto add = [&](const std::vector<ErrorCode>& more) {
      answers.insert(answers.end(), more.begin(), more.end());
    };
    add(change_all(o.world, o));
    add(change_without_ids(o.world));
    add({stepper.step(o.world, frame).error.code, other.step(o.world, frame).error.code, code(stepper.configure({})),
         code(stepper.remove_kernels()), code(stepper.remove_kernel(o.world, "none")),
         code(stepper.add_kernel(o.world, {})), code(stepper.set_parameter("none", {"x", 1.0})),
         code(other.remove_kernel(o.world, "none")), code(other.add_kernel(o.world, {})),
         code(stepper.plan_for(o.world, frame))});
    return Wrench{{1, 0, 0}, {}};
  }));
  run(o.world, stepper, 1);
  CHECK(answers.size() == 45);
  for (const ErrorCode answer : answers) CHECK(answer == ErrorCode::busy);
  CHECK(o.world.body_count() == 3);
  CHECK(must(o.world.velocity(o.a)).x > 0);
  must(o.world.set_pose(o.a, {}));  // and is open again
}

TEST_CASE("misuse: what a callback throws makes the step fail, and the world is as it was") {
  Objects o;
  Stepper stepper;
  bool throws = true;
  (void)must(o.world.add_force(o.a, [&](const World&, BodyId) {
    if (throws) throw std::runtime_error("no such field");
    return Wrench{};
  }));
  const std::uint64_t before = o.world.hash();
  const StepReport& report = stepper.step(o.world, frame);
  CHECK(report.error.code == ErrorCode::bad_argument);
  CHECK(report.error.message.find("body 1 threw \"no such field\"") != std::string::npos);
  CHECK(o.world.hash() == before);
  throws = false;
  run(o.world, stepper, 1);
}

TEST_CASE("misuse: what a step needs cannot be destroyed or moved by a callback") {
  Objects o;
  std::optional<World> world(std::move(o.world));
  std::optional<Stepper> stepper(std::in_place);
  std::function<void()> act;
  (void)must(world->add_force(o.a, [&](const World&, BodyId) {
    act();
    return Wrench{};
  }));
  const auto step_and = [&](const std::function<void()>& what) {
    return [&, what] {
      act = what;
      (void)stepper->step(*world, frame);
    };
  };
  CHECK(says(step_and([&] { stepper.reset(); }), "A Stepper was destroyed while it makes a step"));
  CHECK(says(step_and([&] { *stepper = Stepper(); }), "A Stepper was moved while it makes a step"));
  CHECK(says(step_and([&] { world.reset(); }), "A World was destroyed while a step of it runs"));
  CHECK(says(step_and([&] { World taken(std::move(*world)); }), "A World was moved while a step of it runs"));
}

TEST_CASE("misuse: a world and a stepper that were moved from say so, and can be assigned to") {
  World world;
  const World taken(std::move(world));
  CHECK(says([&] { (void)world.create_body(BodyDef{}); },
             "World::create_body was called on a World that was moved from"));
  CHECK(says([&] { (void)world.hash(); }, "World::hash was called"));
  CHECK(says([&] { (void)world.body_count(); }, "World::body_count was called"));
  Stepper stepper;
  Stepper kept(std::move(stepper));
  CHECK(says([&] { (void)kept.step(world, frame); }, "World::step was called on a World that was moved from"));
  world = World();
  CHECK(world.body_count() == 0);
  CHECK(says([&] { (void)stepper.step(world, frame); }, "Stepper::step was called on a Stepper that was moved from"));
  CHECK(says([&] { (void)stepper.settings(); }, "Stepper::settings was called"));
  stepper = Stepper();
  must(step_status(stepper, world));
}

TEST_CASE("misuse: the value of an error, and the error of a value") {
  World world;
  CHECK(says([&] { (void)*world.pose(BodyId{}); }, "stale_id. This id names no body"));
  CHECK(says([&] { (void)world.pose(BodyId{})->position; }, "which holds an error in its place"));
  CHECK(says([&] { (void)world.pose(world.ground()).error(); }, "it succeeded"));
  CHECK(says([&] { (void)world.set_gravity({}).error(); }, "it succeeded"));
}
