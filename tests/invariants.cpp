// Pins the walk over the invariants of a world: it finds nothing in worlds that are used, whatever the calls were, and
// names each kind of thing that was broken on purpose. Debug builds walk by themselves.
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "step/schedule_invariants.h"
#include "support_last_words.h"
#include "support_world.h"
#include "world/invariants.h"
#include "world/state.h"

using namespace worldtest;

namespace {

/// A world that has one of everything: a stack that sleeps, two balls on a joint that never do, one on a spring,
/// forces, a hand, a table and properties.
struct Yard {
  World world;
  Stepper stepper;
  BodyId floor, low, high, ball, other, hand;
  JointId joint;
  ForceId push, pull;

  Yard() {
    StepSettings settings;
    settings.sleep = true;
    settings.sleep_time = 0.1;
    must(stepper.configure(settings));
    floor = must(world.create_body(fixed_box({0, -0.5, 0}, {20, 0.5, 20})));
    low = must(world.create_body(box({0, 0.5, 0})));
    high = must(world.create_body(box({0, 1.5, 0})));
    BodyDef def;
    def.kind = BodyKind::kinematic;
    def.velocity = {0, 0, 1};
    hand = must(world.create_body(def));
    ball = must(world.create_body(worldtest::ball({6, 3, 0})));
    other = must(world.create_body(worldtest::ball({7, 3, 0})));
    joint = must(world.create_joint(pin(ball, {0.5, 0, 0}, other, {-0.5, 0, 0})));
    SpringDef spring;
    spring.a = must(world.create_body(worldtest::ball({-6, 3, 0})));
    spring.b = hand;
    spring.stiffness = 1;
    (void)must(world.create_spring(spring));
    push = must(world.add_force(ball, Wrench{{1, 0, 0}, {}}));
    pull = must(world.add_force(ball, Wrench{{0, 1, 0}, {}}));
    must(world.set_collide(ball, low, false));
    must(world.set_can_sleep(ball, false));
    (void)must(world.add_property<Real>("heat"));
    (void)must(world.add_property<Vec3>("flow", {}, "1", must(world.add_table("rooms", 3))));
    run(world, stepper, 60);
  }
  static BodyDef box(Vec3 at) {
    BodyDef def;
    def.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
    def.pose.position = at;
    return def;
  }
  WorldState& state() { return world.state(); }
  std::uint32_t row(BodyId body) { return state().body_ids.row(body.index); }
  BodyRecord& record(BodyId body) { return state().bodies[row(body)]; }
};

using Break = std::function<void(Yard&, WorldState&)>;

/// What the walk says of a world in which something is broken, and was not before. In a process of its own: debug
/// builds would not let the test go on.
std::string said_of(const Break& breaks) {
  return last_words([&] {
    Yard yard;
    if (!broken_invariant(yard.state()).empty()) _Exit(0);
    breaks(yard, yard.state());
    walk_invariants(yard.state(), "the test");
  });
}

struct Kind {
  const char* sentence;
  Break breaks;
};
void check(const std::vector<Kind>& kinds) {
  for (const Kind& kind : kinds) {
    const std::string said = said_of(kind.breaks);
    INFO(kind.sentence << " | " << said);
    CHECK(said.find("a world breaks an invariant, seen by the test") != std::string::npos);
    CHECK(said.find(kind.sentence) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("invariants: ids and rows") {
  check({{"is free twice",
          [](Yard& y, WorldState& s) {
            s.body_ids.release(y.ball.index);
            s.body_ids.release(y.ball.index);
          }},
         {"has generation 0", [](Yard& y, WorldState& s) { s.joint_ids.set_generation(y.joint.index, 0); }},
         {"is of an id that is not alive", [](Yard& y, WorldState& s) { s.body_ids.release(y.ball.index); }},
         {"is of an id that names another row", [](Yard& y, WorldState& s) { s.body_ids.set_row(y.ball.index, 1); }},
         {"another number of ids is alive", [](Yard&, WorldState& s) { s.body_ids.allocate(0); }},
         {"the table has another number", [](Yard&, WorldState& s) { s.tables.resize(Table::joint, 9); }},
         {"The table of shapes has other rows", [](Yard&, WorldState& s) { s.shapes.emplace_back(); }},
         {"is not as long as the rows of its table",
          [](Yard&, WorldState& s) { s.tables.bytes(Buffer::pose).resize(16); }}});
}

TEST_CASE("invariants: lists of bodies") {
  check({{"is in two lists of bodies",
          [](Yard& y, WorldState&) { y.record(y.ball).shapes.push_back(y.record(y.low).shapes[0]); }},
         {"is in the list of a body that is not its own",
          [](Yard& y, WorldState&) { std::swap(y.record(y.ball).shapes, y.record(y.low).shapes); }},
         {"is free twice, or was never used", [](Yard&, WorldState& s) { s.free_shapes.assign(2, 0); }},
         {"is alive and in no list", [](Yard& y, WorldState&) { y.record(y.ball).shapes.clear(); }},
         {"is in the list of a body that is not its own",
          [](Yard& y, WorldState&) { std::swap(y.record(y.ball).forces, y.record(y.low).forces); }},
         {"is in its body's list before a smaller one",
          [](Yard& y, WorldState&) { std::swap(y.record(y.ball).forces[0], y.record(y.ball).forces[1]); }},
         {"A force is in no body's list", [](Yard& y, WorldState&) { y.record(y.ball).forces.pop_back(); }},
         {"is not in the lists of both its bodies", [](Yard& y, WorldState&) { y.record(y.other).joints.clear(); }},
         {"is twice in a body's list", [](Yard& y, WorldState&) { y.record(y.other).joints.push_back(y.joint.index); }},
         {"is not between two bodies", [](Yard& y, WorldState& s) { s.joints[1].body_a = y.other.index; }},
         {"is between bodies that never move",
          [](Yard& y, WorldState&) { y.record(y.ball).kind = y.record(y.other).kind = BodyKind::fixed; }}});
}

TEST_CASE("invariants: counts, and what is kept of bodies") {
  check({{"Kinematic bodies are counted wrong", [](Yard&, WorldState& s) { s.kinematic++; }},
         {"Springs are counted wrong", [](Yard&, WorldState& s) { s.springs--; }},
         {"Callbacks are counted wrong", [](Yard&, WorldState& s) { s.callbacks++; }},
         {"its mass is lost, or kept for nothing", [](Yard& y, WorldState& s) { s.frozen[y.ball.index] = {}; }},
         {"its phase does not say so",
          [](Yard& y, WorldState& s) { s.tables.set(Buffer::motion, y.row(y.ball), place::phase, frozen_phase); }},
         {"A mass is kept of a body that is gone", [](Yard&, WorldState& s) { s.frozen[99] = {}; }},
         {"by more or fewer joints than there are",
          [](Yard& y, WorldState& s) { s.no_collide[WorldState::pair_key(y.ball.index, y.other.index)].joints++; }},
         {"A joint does not keep its bodies apart",
          [](Yard& y, WorldState& s) { s.no_collide.erase(WorldState::pair_key(y.ball.index, y.other.index)); }},
         {"for no reason",
          [](Yard& y, WorldState& s) { s.no_collide[WorldState::pair_key(y.low.index, y.other.index)] = {}; }},
         {"one of them is gone", [](Yard&, WorldState& s) { s.no_collide[WorldState::pair_key(1, 99)].asked = true; }},
         {"listed apart from one that it may touch",
          [](Yard& y, WorldState& s) { s.asked_apart[y.ball.index].push_back(y.high.index); }},
         {"listed apart from one twice",
          [](Yard& y, WorldState& s) { s.asked_apart[y.ball.index].push_back(y.low.index); }},
         {"are not in the lists of both", [](Yard& y, WorldState& s) { s.asked_apart.erase(y.low.index); }},
         {"and has a list of them", [](Yard& y, WorldState& s) { s.asked_apart[y.high.index]; }}});
}

TEST_CASE("invariants: contacts") {
  check({{"Contacts have columns of other lengths", [](Yard&, WorldState& s) { s.contacts.keys.pop_back(); }},
         {"stands before one of lower shapes",
          [](Yard&, WorldState& s) {
            std::swap(s.contacts.keys[1], s.contacts.keys[2]);
            std::swap(s.contacts.ends[1], s.contacts.ends[2]);
          }},
         {"is not between two shapes",
          [](Yard&, WorldState& s) { std::swap(s.contacts.keys[1].shape_a, s.contacts.keys[1].shape_b); }},
         {"names other bodies than those of its shapes",
          [](Yard&, WorldState& s) { s.contacts.ends[1] = s.contacts.ends[2]; }},
         {"has no number of points",
          [](Yard&, WorldState& s) { s.tables.set(Buffer::contact, 1, place::point_count, 5); }},
         {"Contacts are to be dropped, and there are none", [](Yard&, WorldState& s) {
            s.tables.resize(Table::contact, 1);
            s.contacts.keys.resize(1);
            s.contacts.ends.resize(1);
            s.contacts.features.resize(1);
            s.drops.make_room(1);
            s.drops.drop(1, 2);
          }}});
}

TEST_CASE("invariants: who sleeps") {
  const auto set = [](BodyId Yard::*body, RestField field, double value) {
    return [=](Yard& y, WorldState& s) {
      s.tables.set(Buffer::rest, y.row(y.*body), field, value);
      s.count_rest();
    };
  };
  check({{"Bodies that sleep are counted wrong", [](Yard&, WorldState& s) { s.sleepers++; }},
         {"Bodies that are stirred are counted wrong", [](Yard&, WorldState& s) { s.stirred++; }},
         {"the world says that none has", [](Yard&, WorldState& s) { s.rests = false; }},
         {"contact row", set(&Yard::low, rest_asleep, 0)},
         {"is between one that sleeps and one that does not", set(&Yard::high, rest_asleep, 0)},
         {"joint row 1 is between one that sleeps and one that does not",
          [&](Yard& y, WorldState& s) {
            s.tables.set3(Buffer::motion, y.row(y.ball), 0, {});
            s.tables.set3(Buffer::motion, y.row(y.ball), 4, {});
            s.tables.set3(Buffer::velocity_parts, y.row(y.ball), 0, {});
            set(&Yard::ball, rest_asleep, 1)(y, s);
          }},
         {"sleeps, and moves", [](Yard& y, WorldState& s) { s.tables.set(Buffer::motion, y.row(y.low), 0, 1); }},
         {"sleeps, and stands", set(&Yard::floor, rest_asleep, 1)}});
}

TEST_CASE("invariants: properties of the host's own, and what is counted") {
  check({{"has the name of another", [](Yard&, WorldState& s) { s.own.list[1].name = s.own.list[0].name; }},
         {"has a buffer of another table", [](Yard&, WorldState& s) { s.own.list[1].table = Table::body; }},
         {"has rows of another length", [](Yard&, WorldState& s) { s.own.list[1].type = PropertyType::mat3; }},
         {"has no row, or generation 0", [](Yard&, WorldState& s) { s.own.tables[0].generation = 0; }},
         {"Objects, kinds or filters have changed, and no version says so",
          [](Yard& y, WorldState& s) { s.shapes[y.record(y.ball).shapes[0]].filter.category = 4; }},
         {"Objects, kinds or filters have changed, and no version says so",
          [](Yard&, WorldState& s) { s.structure_version--; }},
         {"Contacts have changed, and no version says so",
          [](Yard&, WorldState& s) {
            const std::uint32_t rows = s.contact_rows() - 1;
            s.tables.resize(Table::contact, rows);
            s.contacts.keys.resize(rows);
            s.contacts.ends.resize(rows);
            s.contacts.features.resize(rows);
          }},
         {"Other bodies sleep or are stirred, and no version says so",
          [](Yard& y, WorldState& s) {
            s.tables.set(Buffer::rest, y.row(y.low), rest_stirred, 1);
            s.stirred++;
          }},
         {"A count of changes went back", [](Yard&, WorldState& s) { s.joint_changes--; }}});
}

TEST_CASE("invariants: who moves, and trees of joints") {
  const auto said = [](const std::function<void(Yard&, Schedule&)>& breaks) {
    return last_words([&] {
      Yard yard;
      Schedule schedule;
      schedule.update_structure(yard.state());
      if (!broken_invariant(yard.state(), schedule).empty()) _Exit(0);
      breaks(yard, schedule);
      walk_invariants(yard.state(), schedule);
    });
  };
  const auto check_said = [&](const char* sentence, const std::function<void(Yard&, Schedule&)>& breaks) {
    const std::string words = said(breaks);
    INFO(sentence << " | " << words);
    CHECK(words.find(sentence) != std::string::npos);
  };
  check_said("is to move twice", [](Yard& y, Schedule& s) { s.bodies[0] = y.row(y.other); });
  check_said("does not move", [](Yard& y, Schedule& s) { s.bodies[0] = y.row(y.low); });
  check_said("moves, and is in no list", [](Yard&, Schedule& s) { s.bodies[0] = 0; });
  check_said("is in a tree between other bodies than its own", [](Yard& y, Schedule&) {
    y.state().joints[y.state().joint_ids.row(y.joint.index)].body_a = y.hand.index;
  });
  check_said("is in a tree, and is a spring or sleeps",
             [](Yard& y, Schedule&) { y.state().joints[y.state().joint_ids.row(y.joint.index)].spring = SpringDef(); });
  check_said("holds, and stands in no tree and closes no loop", [](Yard& y, Schedule&) {
    for (JointRecord& joint : y.state().joints) joint.spring.reset();
  });
}

TEST_CASE("invariants: hold after each call and each step") {
  Yard yard;
  const auto broken = [&] { return broken_invariant(yard.state()); };
  CHECK(broken() == "");
  CHECK(yard.state().sleepers == 2);
  const std::vector<std::byte> saved = yard.world.snapshot();
  must(yard.world.wake(yard.high));
  CHECK(broken() == "");
  (void)must(yard.world.create_ragdoll(RagdollDef::human(), {{0, 4, 0}, {}}));
  CHECK(broken() == "");
  run(yard.world, yard.stepper, 1);
  CHECK(broken() == "");
  must(yard.world.destroy(yard.low));
  CHECK(broken() == "");
  must(yard.world.destroy(yard.ball));
  CHECK(broken() == "");
  for (int i = 0; i < 30; i++) {
    run(yard.world, yard.stepper, 1);
    CHECK(broken() == "");
  }
  CHECK_FALSE(yard.world.restore(saved));
  CHECK(broken() == "");
}

TEST_CASE("invariants: large worlds are walked when their calls have paid for it") {
  World world;
  std::vector<BodyDef> many(3000, ball({}));
  for (std::size_t i = 0; i < many.size(); i++) {
    many[i].pose.position = {double(i), 0, 0};
    (void)must(world.create_body(many[i]));
  }
  WorldState& s = world.state();
  walk_when_due(s, "the test");
  s.seen.rows_paid = 0;
  int calls = 1;
  for (; calls < 100; calls++) {
    walk_when_due(s, "the test");
    if (s.seen.rows_paid == 0) break;
  }
  CHECK(calls == 6);  // for 3001 bodies, 3000 shapes and the rows that pad
}

#ifndef NDEBUG
TEST_CASE("invariants: debug builds walk by themselves, and tell after which call") {
  CHECK(says(
      [] {
        Yard yard;
        must(yard.world.wake(yard.low));
        yard.state().kinematic++;
        (void)yard.world.set_gravity({});
      },
      "seen by set_gravity, after wake. Kinematic bodies are counted wrong."));
  CHECK(says(
      [] {
        Yard yard;
        yard.state().kinematic++;
      },
      "seen by ~World, after step."));
}
#endif
