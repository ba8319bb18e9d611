// Pins flight, where one kernel makes all sub-steps of a body: its bits are those of begin, integrate, advance and
// synchronise one after the other, with drag and without, for equal moments and others, in both precisions, and a world
// goes from one to the other and back; a body that would leave the range of numbers is frozen while all others fly on;
// what of a step it needs not is not there; and only what acts in each sub-step keeps a world from it.
#include <algorithm>

#include "pcphys/write_kernel.h"
#include "support_world.h"

using namespace worldtest;

namespace {

PCPHYS_KERNEL(count_steps, (PC_INOUT(uint) steps), { steps = steps + 1u; })

struct Kind {
  const char* name;
  bool round, drag;
  const char* kernel;
};
constexpr Kind kinds[] = {{"balls", true, false, "fly_round"},
                          {"bars", false, false, "fly"},
                          {"balls with drag", true, true, "fly_round_drag"},
                          {"bars with drag", false, true, "fly_drag"}};

/// Bodies in flight, one of them kinematic and one pushed.
std::vector<BodyId> add_bodies(World& world, const Kind& kind) {
  std::vector<BodyId> bodies;
  for (int i = 0; i < 19; i++) {
    BodyDef def = ball({3.0 * i, 10, 0}, 0.2 + 0.01 * i);
    if (!kind.round) def.shapes = {ShapeDef::box({0.1, 0.2, 0.3 + 0.01 * i})};
    def.shapes[0].filter.mask = 0;
    def.velocity = {0.1 * i, 3.0 - i, 0.5};
    def.angular_velocity = {1.0 * i, -4, 0.3 * i};
    if (i == 7) def.angular_velocity = {};
    if (kind.drag && i % 3 > 0) def.linear_drag = 0.2 * i;
    if (kind.drag && i % 4 > 0) def.angular_drag = 0.3 * i;
    if (i == 4) def.kind = BodyKind::kinematic;
    bodies.push_back(must(world.create_body(def)));
  }
  (void)must(world.add_force(bodies[2], Wrench{{1, 2, 3}, {0.1, 0.2, 0}}));
  return bodies;
}

/// A pendulum beside them: no step of this world is a flight.
std::vector<BodyId> add_pendulum(World& world) {
  BodyDef def = ball({0, -50, 0});
  def.shapes[0].filter.mask = 0;
  const BodyId bob = must(world.create_body(def));
  (void)must(world.create_joint(pin(world.ground(), {0, -49, 0}, bob, {0, 1, 0})));
  return {bob};
}

}  // namespace

TEST_CASE("a flight has the bits of its sub-steps one after the other") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const Kind& kind : kinds)
      for (const std::uint32_t substeps : {1u, 4u}) {
        CAPTURE(kind.name);
        CAPTURE(substeps);
        StepSettings settings;
        settings.substeps = substeps;
        World alone({precision}), beside({precision});
        Stepper flying(settings), stepping(settings);
        const std::vector<BodyId> a = add_bodies(alone, kind), b = add_bodies(beside, kind);
        const std::vector<BodyId> others = add_pendulum(beside);
        for (int i = 0; i < 40; i++) {
          const double dt = i < 20 ? frame : 1.0 / 100;
          run(alone, flying, 1, dt);
          run(beside, stepping, 1, dt);
          CHECK(flying.plan().flight);
          CHECK(flying.plan().entries.size() == 1);
          CHECK(runs(flying.plan(), kind.kernel));
          CHECK_FALSE(stepping.plan().flight);
          if (i == 10) {
            must(alone.set_velocity(a[3], {1, 2, 3}));
            must(beside.set_velocity(b[3], {1, 2, 3}));
          }
          REQUIRE((states(alone, a) == states(beside, b)));
        }
        for (const BodyId id : others) must(beside.destroy(id));
        CHECK(alone.hash() == beside.hash());
        run(alone, flying, 5);
        run(beside, stepping, 5);
        CHECK(stepping.plan().flight);
        CHECK(alone.hash() == beside.hash());
      }
}

TEST_CASE("a flight has the same bits in all lanes, in threads and on GL") {
  check_same_bits(
      [](const StepSettings& settings, int steps) {
        std::vector<std::uint64_t> hashes(std::size_t(steps), 0);
        for (const Kind& kind : kinds) {
          World world({Precision::f32});
          (void)add_bodies(world, kind);
          Stepper stepper(settings);
          for (std::uint64_t& hash : hashes) {
            run(world, stepper, 1);
            hash = hash * 31 + world.hash();
          }
        }
        return hashes;
      },
      30, 5);
}

TEST_CASE("a body that would leave the range of numbers is frozen in flight, and all others fly on") {
  for (const Place place : {Place::cpu, Place::gl}) {
    if (place == Place::gl) require_gl();
    World world({Precision::f32}), sound({Precision::f32});
    const std::vector<BodyId> bodies = add_bodies(world, kinds[0]), same = add_bodies(sound, kinds[0]);
    StepSettings settings;
    settings.set_all(place);
    Stepper stepper(settings), other(settings);
    run(world, stepper, 3);
    run(sound, other, 3);
    const Pose before = *world.pose(bodies[5]);
    must(world.set_mass_properties(bodies[5], {1e-30, {1e-30, 1e-30, 1e-30}}));
    (void)must(world.add_force(bodies[5], Wrench{{1e15, 0, 0}, {}}));
    for (int i = 0; i < 4; i++) {
      const StepReport& report = stepper.step(world, frame);
      REQUIRE(report);
      CHECK(report.frozen == (i == 0 ? std::vector<BodyId>{bodies[5]} : std::vector<BodyId>{}));
      CHECK(stepper.plan().flight);
    }
    run(sound, other, 4);
    CHECK(*world.frozen(bodies[5]));
    CHECK((*world.pose(bodies[5]) == before));
    CHECK((*world.velocity(bodies[5]) == Vec3{}));
    for (std::size_t i = 0; i < bodies.size(); i++)
      if (i != 5) CHECK((states(world, {bodies[i]}) == states(sound, {same[i]})));
  }
}

// On the CPU such a step was made anew from the velocities that it had left, and only where bodies may sleep.
TEST_CASE(
    "a body that a force sends past what it was not looked for has the step of its flight made anew, in all places") {
  require_gl();
  std::vector<BodyState> wanted;
  for (const bool sleep : {false, true})
    for (const Place place : {Place::cpu, Place::gl}) {
      CAPTURE(sleep);
      World world({Precision::f32, {}});
      (void)must(world.create_body(fixed_box({0, -0.05, 0}, {5, 0.05, 5})));
      const BodyId thrown = must(world.create_body(ball({0, 3, 0}, 0.1)));
      const double newtons = 1.2e5;  // 4 m within the step
      (void)must(world.add_force(thrown, [=](const World&, BodyId) { return Wrench{{0, -newtons, 0}, {}}; }));
      StepSettings settings;
      settings.set_all(place);
      settings.sleep = sleep;
      Stepper stepper(settings);
      const StepReport& report = stepper.step(world, frame);
      REQUIRE(report);
      CHECK(report.repeats == 1);
      if (wanted.empty()) wanted = states(world, {thrown});
      CHECK((states(world, {thrown}) == wanted));
    }
}

TEST_CASE("only kernels of the host's own that look at bodies between sub-steps keep them from flight") {
  World world({Precision::f32});
  (void)add_bodies(world, kinds[0]);
  must(world.add_property<std::uint32_t>("steps", 0, "1"));
  Stepper stepper;
  must(stepper.add_kernel(world, {.text = count_steps::text(), .once_a_step = true}));
  run(world, stepper, 2);
  CHECK(stepper.plan().flight);
  must(stepper.remove_kernel(world, "count_steps"));
  must(stepper.add_kernel(world, {.text = count_steps::text()}));
  run(world, stepper, 1);
  CHECK_FALSE(stepper.plan().flight);
  CHECK(runs(stepper.plan(), "advance_round"));
}

TEST_CASE("a world in flight has no buffer of joints, contacts, sub-steps or collision") {
  for (const bool drag : {false, true}) {
    World world({Precision::f32});
    (void)add_bodies(world, kinds[drag ? 2 : 0]);
    Stepper stepper;
    run(world, stepper, 3);
    for (const BufferUse& use : stepper.memory(world)) {
      CAPTURE(std::string(use.name));
      CHECK((use.table == "body" || use.table == "shape" || use.name == "bodies" || use.name == "objects" ||
             use.name == "schedule"));
      CHECK(use.name != "inertia");
      CHECK(use.name != "delta");
      CHECK(use.name != "drag_terms");
      CHECK(use.name != "collision");
      CHECK(use.name != "rollback");
    }
  }
  SceneWorld falling = scene_world("balls", 4);
  Stepper stepper;
  run(falling.world, stepper, 100);
  const auto has = [&](std::string_view name) {
    const std::vector<BufferUse> uses = stepper.memory(falling.world);
    return std::ranges::find(uses, name, &BufferUse::name) != uses.end();
  };
  CHECK(has("contact"));
  CHECK(has("delta"));
  CHECK(has("collision"));
  CHECK_FALSE(has("drag_terms"));
  CHECK_FALSE(has("tree_rows"));
  CHECK_FALSE(has("joint_rows"));
}

TEST_CASE("what no step has used reads as it was made") {
  World world({Precision::f32});
  const std::vector<BodyId> bodies = add_bodies(world, kinds[0]);
  Stepper stepper;
  run(world, stepper, 2);
  const PropertyView view = must(world.view("inverse_inertia"));
  CHECK(view.count >= bodies.size());
  for (std::size_t i = 0; i < view.count; i++) CHECK(view.at(i, 0) == 0);
}

// ---- results that stay on the device -----------------------------------------------------------------------------

namespace {
StepSettings resident() {
  StepSettings settings;
  settings.set_all(Place::gl);
  settings.resident = true;
  return settings;
}
}  // namespace

TEST_CASE("resident: nothing comes down until it is asked for, and then it is what a step on the CPU gives") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World there({precision}), here({precision});
    const std::vector<BodyId> a = add_bodies(there, kinds[1]), b = add_bodies(here, kinds[1]);
    Stepper on_device(resident()), on_host;
    for (int i = 0; i < 12; i++) {
      const StepReport& report = on_device.step(there, frame);
      REQUIRE(report);
      if (i > 0 && i != 6 && i != 9) CHECK(report.transfer_bytes == 0);
      run(here, on_host, 1);
      if (i == 3) CHECK(there.hash() == here.hash());
      if (i == 4) CHECK((states(there, a) == states(here, b)));
      if (i == 5) {  // what the host writes goes up again
        must(there.set_velocity(a[3], {1, 2, 3}));
        must(here.set_velocity(b[3], {1, 2, 3}));
      }
      if (i == 8) {  // other rows, another place in memory
        must(there.destroy(a[0]));
        must(here.destroy(b[0]));
      }
    }
    CHECK(there.hash() == here.hash());
  }
}

TEST_CASE("resident: what a device holds comes home when its stepper goes, changes or steps another world") {
  require_gl();
  World here({Precision::f32});
  (void)add_bodies(here, kinds[0]);
  Stepper on_host;
  run(here, on_host, 5);
  enum { goes, changes, other_world, other_stepper };
  for (const int what : {goes, changes, other_world, other_stepper}) {
    CAPTURE(what);
    World there({Precision::f32}), other({Precision::f32});
    (void)add_bodies(there, kinds[0]);
    (void)add_bodies(other, kinds[1]);
    auto stepper = std::make_unique<Stepper>(resident());
    run(there, *stepper, what == other_stepper || what == changes ? 3 : 5);
    if (what == goes) stepper.reset();
    if (what == changes) {
      must(stepper->configure(lanes(4)));
      run(there, *stepper, 2);
    }
    if (what == other_world) run(other, *stepper, 1);
    if (what == other_stepper) {
      Stepper next(resident());
      run(there, next, 2);
      stepper.reset();
    }
    CHECK(there.hash() == here.hash());
  }
  Stepper longer(resident());
  {
    World shorter({Precision::f32});
    (void)add_bodies(shorter, kinds[0]);
    run(shorter, longer, 2);
  }
  run(here, longer, 1);  // the world that it held is gone
}

TEST_CASE("resident: a world that comes to meet something goes on as on the CPU") {
  require_gl();
  SceneWorld there = scene_world("balls", 8), here = scene_world("balls", 8);
  Stepper on_device(resident()), on_host;
  for (int i = 0; i < 50; i++) {
    run(there.world, on_device, 1);
    run(here.world, on_host, 1);
    REQUIRE(there.world.hash() == here.world.hash());
  }
}
