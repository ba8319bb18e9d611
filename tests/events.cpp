// Pins events: who touched, let go, was hit and moved is told once, in stable order, with the numbers that mechanics
// gives; the lists are the same to the bit in all lanes and threads, on GL and in all mixes of places; asking changes
// no bit of the motion; what is not asked for is not told; a failed step tells nothing; ids of what is gone are told
// once more, as ended.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "support_sleep.h"

using namespace worldtest;

namespace {

void ask_for_all(StepSettings& s) { s.contact_events = s.hit_events = s.body_events = true; }
StepSettings all_events(double hit_speed = 1) {
  StepSettings s;
  ask_for_all(s);
  s.hit_speed = hit_speed;
  return s;
}

/// FNV-1a over everything that the lists hold, in their order.
class ListHash {
 public:
  void add(const StepEvents& e) {
    for (const ContactBegun& c : e.begun) add(1), meeting(c);
    for (const ContactEnded& c : e.ended) add(2), pair(c);
    for (const ContactHit& c : e.hits) add(3), meeting(c), add(c.speed), add(c.impulse);
    for (const BodyId id : e.moved) add(4), body(id);
    for (const BodyId id : e.slept) add(5), body(id);
    for (const BodyId id : e.woken) add(6), body(id);
  }
  std::uint64_t value() const { return hash_; }

 private:
  template <class T> void add(const T& value) {
    unsigned char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 1099511628211ull;
  }
  void body(BodyId id) { add(id.index), add(id.generation); }
  void pair(const TouchingPair& p) { body(p.a), body(p.b), add(p.shape_a), add(p.shape_b); }
  void meeting(const ContactBegun& c) { pair(c), add(c.normal), add(c.point); }
  std::uint64_t hash_ = 14695981039346656037ull;
};

/// Hashes of all lists up to each of so many steps; `act` comes before a step, `look` at what it told.
template <class Act, class Look>
std::vector<std::uint64_t> hash_lists(World& world, Stepper& stepper, int steps, Act&& act, Look&& look) {
  std::vector<std::uint64_t> hashes;
  ListHash hash;
  for (int i = 0; i < steps; i++) {
    act(i);
    run(world, stepper, 1);
    look(stepper.events());
    hash.add(stepper.events());
    hashes.push_back(hash.value());
  }
  return hashes;
}
StepSettings asking(StepSettings settings) {
  ask_for_all(settings);
  return settings;
}
constexpr auto no_act = [](int) {};

HashesOf lists_of(const char* scene, int count, Precision precision) {
  return [=](const StepSettings& settings, int steps) {
    SceneWorld s = scene_world(scene, count, precision);
    Stepper stepper(asking(settings));
    return hash_lists(s.world, stepper, steps, no_act, [](const StepEvents&) {});
  };
}
/// Two towers fall asleep, and the first is pushed over then; what lies down may wake the other, and sleeps again.
HashesOf lists_of_sleepers(Precision precision) {
  return [=](const StepSettings& settings, int steps) {
    Towers t(2, precision);
    t.stepper = Stepper(asking(sleepy(settings)));
    std::size_t slept = 0, woken = 0;
    const auto push = [&](int step) {
      if (step == 60) must(t.world.set_velocity(t.cubes[2], {3, 2, 0}));
    };
    const auto hashes = hash_lists(t.world, t.stepper, steps, push,
                                   [&](const StepEvents& e) { slept += e.slept.size(), woken += e.woken.size(); });
    CHECK(slept >= 6);
    CHECK(woken >= 3);
    return hashes;
  };
}
HashesOf lists_in_flight(Precision precision) {
  return [=](const StepSettings& settings, int steps) {
    SceneWorld s = scene_world("ballistic", 20, precision);
    StepSettings with = asking(settings);
    with.resident = true;
    Stepper stepper(with);
    return hash_lists(s.world, stepper, steps, no_act,
                      [&](const StepEvents& e) { CHECK(e.moved.size() == s.world.bodies().size()); });
  };
}

BodyDef floor_at(double height) { return fixed_box({0, height - 0.5, 0}, {10, 0.5, 10}); }

}  // namespace

TEST_CASE("a ball that drops, rolls on and is lifted away") {
  World world;
  const BodyId floor = must(world.create_body(floor_at(0)));
  BodyDef def = ball({1, 2, 0});
  def.mass = 3;
  const BodyId body = must(world.create_body(def));
  Stepper stepper(all_events());
  int begun = 0, ended = 0, hits = 0;
  const auto step = [&](int steps) {
    for (int i = 0; i < steps; i++) {
      run(world, stepper, 1);
      const StepEvents e = stepper.events();
      for (const ContactBegun& c : e.begun) {
        begun++;
        CHECK(c.a == body);
        CHECK(c.b == floor);
        CHECK(c.normal == Vec3{0, -1, 0});
        CHECK(length(c.point - Vec3{1, 0, 0}) < 1e-2);
      }
      for (const ContactHit& c : e.hits) {
        hits++;
        const double speed = std::sqrt(2 * 9.81 * 1.5);  // as the step began, so up to g dt less
        CHECK(c.speed == doctest::Approx(speed).epsilon(0.035));
        CHECK(c.impulse == doctest::Approx(3 * speed).epsilon(0.05));
      }
      ended += int(e.ended.size());
    }
  };
  step(30);
  CHECK(begun == 0);
  CHECK(stepper.events().moved.size() == 1);
  step(90);
  CHECK(begun == 1);
  CHECK(hits == 1);
  CHECK(ended == 0);
  must(world.set_pose(body, Pose{{1, 3, 0}, {}}));
  step(1);
  CHECK(ended == 1);
  CHECK(begun == 1);
}

TEST_CASE("an elastic blow: the speed at the instant, the whole impulse, the place where they met") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    for (const bool both_fly : {false, true}) {
      World world(WorldDef{precision, {}});
      BodyDef one = ball({-0.9, 0, 0}), two = ball({1, 0, 0});
      one.mass = 2, two.mass = 6;
      one.material.restitution = two.material.restitution = 0.5;
      one.velocity = {20, 0, 0};
      if (both_fly) two.velocity = {-10, 0, 0};
      const BodyId a = must(world.create_body(one)), b = must(world.create_body(two));
      Stepper stepper(all_events());
      int hits = 0;
      for (int i = 0; i < 6; i++) {
        run(world, stepper, 1);
        for (const ContactHit& c : stepper.events().hits) {
          hits++;
          const double speed = both_fly ? 30 : 20, reduced = 2.0 * 6 / 8, meets = -0.4 + 20 * 0.9 / speed;
          CHECK((c.a == a && c.b == b));
          CHECK(c.speed == doctest::Approx(speed).epsilon(1e-5));
          CHECK(c.impulse == doctest::Approx(1.5 * reduced * speed).epsilon(1e-5));
          CHECK(c.point.x == doctest::Approx(meets).epsilon(1e-4));
          CHECK(std::abs(c.normal.x - 1) < 1e-6);
        }
      }
      CHECK(hits == 1);
    }
  }
}

TEST_CASE("a box that lands flat is hit in its middle, with all its momentum") {
  World world;
  (void)must(world.create_body(floor_at(0)));
  BodyDef box;
  box.shapes = {ShapeDef::box({0.5, 0.25, 0.5})};
  box.mass = 4;
  box.pose.position = {3, 1.5, 0};
  for (const double restitution : {0.0, 0.5}) {
    box.material.restitution = restitution;
    const BodyId body = must(world.create_body(box));
    Stepper stepper(all_events(3));
    int hits = 0;
    for (int i = 0; i < 40; i++) {
      run(world, stepper, 1);
      for (const ContactHit& c : stepper.events().hits) {
        hits++;
        const double speed = std::sqrt(2 * 9.81 * 1.25), e = restitution / 2;  // the mean with the floor's
        CHECK(c.speed == doctest::Approx(speed).epsilon(0.035));
        CHECK(c.impulse == doctest::Approx(4 * (1 + e) * speed).epsilon(0.05));
        CHECK(length(c.point - Vec3{3, 0, 0}) < 1e-2);
      }
    }
    CHECK(hits == 1);
    must(world.destroy(body));
  }
}

TEST_CASE("what passes close by touches nothing, and what rests hits nothing") {
  World world(WorldDef{.gravity = {}});
  (void)must(world.create_body(fixed_box({0, 0, 0}, {0.5, 0.5, 0.5})));
  BodyDef def = ball({-3, 1.001, 0});  // a millimetre above
  def.velocity = {30, 0, 0};
  (void)must(world.create_body(def));
  Stepper stepper(all_events(0));
  for (int i = 0; i < 20; i++) {
    run(world, stepper, 1);
    CHECK(stepper.events().begun.empty());
    CHECK(stepper.events().hits.empty());
  }
  SceneWorld stack = scene_world("stack", 5);
  Stepper of_stack(all_events(0.2));
  run(stack.world, of_stack, 120);
  int begun = 0;
  for (int i = 0; i < 60; i++) {
    run(stack.world, of_stack, 1);
    begun += int(of_stack.events().begun.size() + of_stack.events().ended.size());
    CHECK(of_stack.events().hits.empty());
  }
  CHECK(begun == 0);
}

TEST_CASE("shapes of compounds are told by their place, and destroyed bodies end what they touched") {
  World world;
  const BodyId floor = must(world.create_body(floor_at(0)));
  BodyDef table;
  table.shapes = {ShapeDef::sphere(0.2), ShapeDef::sphere(0.2), ShapeDef::box({0.4, 0.05, 0.4})};
  table.shapes[0].local.position = {-1, 0, 0};
  table.shapes[1].local.position = {1, 0, 0};
  table.shapes[2].local.position = {0, 0.3, 0};
  must(make_compound(table));
  table.pose.position.y += 0.2;
  const BodyId body = must(world.create_body(table));
  Stepper stepper(all_events());
  std::vector<ContactBegun> begun;
  for (int i = 0; i < 30; i++) {
    run(world, stepper, 1);
    begun.insert(begun.end(), stepper.events().begun.begin(), stepper.events().begun.end());
  }
  REQUIRE(begun.size() >= 2);
  CHECK(begun[0].shape_a != begun[1].shape_a);
  for (const ContactBegun& c : begun) {
    CHECK(c.a == body);
    CHECK(c.shape_a < 2);
    CHECK(c.shape_b == 0);
  }
  must(world.destroy(body));
  const BodyId other = must(world.create_body(table));  // takes the places of the shapes that are gone
  run(world, stepper, 1);
  REQUIRE(stepper.events().ended.size() == 2);
  CHECK(stepper.events().ended[0].a == body);
  CHECK_FALSE(world.valid(stepper.events().ended[0].a));
  CHECK(stepper.events().ended[0].b == floor);
  for (const ContactBegun& c : stepper.events().begun) CHECK(c.a == other);
}

TEST_CASE("moved: those whose pose changed, by id; not those that stand") {
  World world(WorldDef{.gravity = {}});
  BodyDef still = ball({0, 0, 0}), goes = ball({5, 0, 0}), turns = ball({0, 5, 0}), carried = ball({0, 0, 9});
  goes.velocity = {1, 0, 0};
  turns.angular_velocity = {0, 1, 0};
  carried.kind = BodyKind::kinematic;
  carried.velocity = {0, 0, 1};
  (void)must(world.create_body(still));
  const BodyId gone = must(world.create_body(still)), first = must(world.create_body(goes)),
               second = must(world.create_body(turns));
  must(world.set_pose(gone, Pose{{0, -9, 0}, {}}));
  must(world.destroy(gone));  // rows are no longer in the order of ids
  const BodyId third = must(world.create_body(carried));
  Stepper stepper(all_events());
  for (int i = 0; i < 3; i++) {
    run(world, stepper, 1);
    const StepEvents e = stepper.events();
    CHECK(std::vector<BodyId>(e.moved.begin(), e.moved.end()) == std::vector<BodyId>{third, first, second});
  }
}

TEST_CASE("slept and woken are told once, and a touch lasts while its bodies sleep") {
  SceneWorld s = scene_world("stack", 3);
  StepSettings settings = all_events();
  settings.sleep = true;
  Stepper stepper(settings);
  std::vector<BodyId> slept, woken;
  int begun = 0, ended = 0;
  const auto step = [&](int steps) {
    for (int i = 0; i < steps; i++) {
      run(s.world, stepper, 1);
      const StepEvents e = stepper.events();
      slept.insert(slept.end(), e.slept.begin(), e.slept.end());
      woken.insert(woken.end(), e.woken.begin(), e.woken.end());
      begun += int(e.begun.size()), ended += int(e.ended.size());
    }
  };
  step(600);
  REQUIRE(slept.size() == 3);
  CHECK(std::ranges::is_sorted(slept));
  CHECK(woken.empty());
  CHECK(begun == 3);
  CHECK(ended == 0);
  CHECK(stepper.events().moved.empty());
  must(s.world.wake(slept[0]));
  step(1);
  CHECK(woken == slept);
  Stepper late(settings);  // knows nobody yet
  step(400);
  run(s.world, late, 1);
  CHECK(ended == 0);
  must(s.world.set_velocity(slept[2], {0, 3, 0}));
  step(20);
  CHECK(ended == 1);
}

TEST_CASE("moved in flight, where steps keep no copy of the poses") {
  SceneWorld s = scene_world("ballistic", 20), plain = scene_world("ballistic", 20);
  Stepper stepper(all_events()), without;
  run(s.world, stepper, 5);
  run(plain.world, without, 5);
  CHECK(stepper.plan().flight);
  CHECK(stepper.events().moved.size() == s.world.bodies().size());
  CHECK(s.world.hash() == plain.world.hash());
}

TEST_CASE("only what is asked for; and a failed step tells nothing") {
  SceneWorld s = scene_world("balls", 20), plain = scene_world("balls", 20);
  Stepper without, stepper(all_events());
  for (int i = 0; i < 60; i++) {
    run(s.world, stepper, 1);
    run(plain.world, without, 1);
    const StepEvents none = without.events();
    CHECK((none.begun.empty() && none.ended.empty() && none.hits.empty() && none.moved.empty()));
  }
  CHECK(s.world.hash() == plain.world.hash());
  CHECK(stepper.events().moved.size() > 0);
  CHECK_FALSE(step_status(stepper, s.world, -1));
  CHECK(stepper.events().moved.empty());
  StepSettings bad;
  bad.hit_speed = -1;
  const Status refused = stepper.configure(bad);
  CHECK_FALSE(refused);
  CHECK(refused.error().message.find("speed of hits") != std::string::npos);
}

TEST_CASE("the same lists in all lanes and threads, on GL and in all mixes") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    check_same_bits(lists_of("balls", 40, precision), 90, 60);
    check_same_bits(lists_of("ragdolls", 2, precision), 90, 45);
    check_same_bits(lists_of("dominoes", 12, precision), 90, 45);
    check_same_bits(lists_of_sleepers(precision), 90, 90);
    check_same_bits(lists_in_flight(precision), 10, 5);
  }
}
