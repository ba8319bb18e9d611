// Pins snapshots: a restored world is the same to the bit and goes on as the run that went on, contacts' warm
// start included, in the same world, in a twin, and in a twin with another past; bytes that are cut, changed
// or of another world are refused and change nothing.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "support_world.h"
#include "world/invariants.h"
#include "world/state_rows.h"

using namespace worldtest;

namespace {

struct Case {
  const char* scene;
  int count, steps;
};
constexpr Case cases[] = {{"balls", 30, 90}, {"ragdolls", 2, 90}, {"pyramid", 6, 60},  {"stack", 5, 60},
                          {"chain", 8, 30},  {"door", 1, 45},     {"dominoes", 8, 60}, {"hulls", 8, 60}};
constexpr int more = 40;
constexpr Precision both[] = {Precision::f32, Precision::f64};

}  // namespace

TEST_CASE("restored bit for bit, and goes on as the run that went on") {
  for (const Precision precision : both)
    for (const Case& c : cases) {
      INFO(std::string(c.scene) << std::string(precision == Precision::f32 ? ", float" : ", double"));
      SceneWorld s = scene_world(c.scene, c.count, precision);
      Stepper stepper;
      run(s.world, stepper, c.steps);
      const std::uint64_t hash = s.world.hash();
      const std::size_t contacts = s.world.contact_count();
      const std::vector<std::byte> snapshot = s.world.snapshot();
      if (std::string(c.scene) != "chain") CHECK(contacts > 0);
      run(s.world, stepper, more);
      const std::uint64_t later = s.world.hash();
      CHECK(later != hash);

      // in the world itself, with the stepper that saw what came after
      must(s.world.restore(snapshot));
      CHECK(s.world.hash() == hash);
      CHECK(s.world.contact_count() == contacts);
      CHECK(s.world.snapshot() == snapshot);
      run(s.world, stepper, more);
      CHECK(s.world.hash() == later);

      // in a twin that has seen nothing
      SceneWorld twin = scene_world(c.scene, c.count, precision);
      must(twin.world.restore(snapshot));
      CHECK(twin.world.hash() == hash);
      Stepper fresh;
      run(twin.world, fresh, more);
      CHECK(twin.world.hash() == later);
    }
}

TEST_CASE("restored after bodies were moved, pushed and turned") {
  for (const Precision precision : both) {
    SceneWorld s = scene_world("ragdolls", 2, precision);
    Stepper stepper;
    run(s.world, stepper, 80);
    const std::uint64_t hash = s.world.hash();
    const std::vector<std::byte> snapshot = s.world.snapshot();
    run(s.world, stepper, more);
    const std::uint64_t later = s.world.hash();
    must(s.world.restore(snapshot));
    int n = 0;
    for (BodyId body : s.world.bodies()) {
      if (must(s.world.kind(body)) != BodyKind::dynamic) continue;
      must(s.world.set_pose(body, {{0.1 * n, 50, 0}, axis_angle({0, 0, 1}, 0.1 * n)}));
      must(s.world.set_velocity(body, {0, 1.0 * n, 0}));
      must(s.world.set_angular_velocity(body, {1.0 * n, 0, 0}));
      n++;
    }
    must(s.world.set_gravity({1, 2, 3}));
    run(s.world, stepper, 7);
    CHECK(s.world.hash() != hash);
    must(s.world.restore(snapshot));
    CHECK(s.world.hash() == hash);
    CHECK(s.world.gravity() == Vec3{0, -9.81, 0});
    run(s.world, stepper, more);
    CHECK(s.world.hash() == later);
  }
}

TEST_CASE("restored into a world whose bodies lie in other rows") {
  const auto build = [](bool detour) {
    World world;
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
    std::vector<BodyId> ids;
    for (int i = 0; i < 4; i++) ids.push_back(must(world.create_body(ball({0.3 * i, 0.5 + 1.1 * i, 0.1 * i}))));
    must(world.destroy(ids[0]));
    must(world.destroy(ids[3]));
    if (!detour) {
      (void)must(world.create_body(ball({0, 0.5, 0})));
      (void)must(world.create_body(ball({0.9, 3.8, 0.3})));
      return world;
    }
    // the same ids in the end, in another order of rows
    (void)must(world.create_body(ball({0, 0.5, 0})));
    const BodyId last = must(world.create_body(ball({0.9, 3.8, 0.3})));
    CHECK(must(world.row_of(last)) == 5);
    return world;
  };
  World a = build(false), b = build(true);
  Stepper stepper, other;
  run(a, stepper, 60);
  must(b.restore(a.snapshot()));
  CHECK(a.hash() == b.hash());
  run(a, stepper, 60);
  run(b, other, 60);
  CHECK(a.hash() == b.hash());
}

TEST_CASE("cut, changed and foreign snapshots are refused, and change nothing") {
  SceneWorld s = scene_world("stack", 3);
  Stepper stepper;
  run(s.world, stepper, 20);
  const std::vector<std::byte> snapshot = s.world.snapshot();
  run(s.world, stepper, 10);
  World& w = s.world;
  const char* cut = "These bytes are no whole snapshot; take them from World::snapshot, unchanged.";
  for (std::size_t n = 0; n < snapshot.size(); n += n < 80 ? 1 : 37)
    CHECK_REFUSED(w, w.restore(std::span(snapshot).first(n)), ErrorCode::bad_snapshot, "");
  CHECK_REFUSED(w, w.restore({}), ErrorCode::bad_snapshot, cut);
  std::vector<std::byte> longer = snapshot;
  longer.push_back({});
  CHECK_REFUSED(w, w.restore(longer), ErrorCode::bad_snapshot, cut);
  for (std::size_t i = 0; i < snapshot.size(); i += i < 120 ? 1 : 13) {
    INFO("byte " << i);
    std::vector<std::byte> changed = snapshot;
    changed[i] ^= std::byte(1u << (i % 8));
    CHECK_REFUSED(w, w.restore(changed), ErrorCode::bad_snapshot, "");
  }
  const char* foreign =
      "The snapshot is of a world with other objects, shapes, properties or another precision; restore it into one "
      "with the same "
      "bodies, joints, properties and tables.";
  CHECK_REFUSED(w, w.restore(scene_world("stack", 4).world.snapshot()), ErrorCode::bad_snapshot, foreign);
  CHECK_REFUSED(w, w.restore(scene_world("stack", 3, Precision::f64).world.snapshot()), ErrorCode::bad_snapshot,
                foreign);
  CHECK_REFUSED(w, w.restore(scene_world("chain", 3).world.snapshot()), ErrorCode::bad_snapshot, foreign);
  CHECK_REFUSED(w, w.restore(World().snapshot()), ErrorCode::bad_snapshot, foreign);
  must(w.restore(snapshot));
  CHECK(w.snapshot() == snapshot);
}

namespace {
/// Into a snapshot, and the sum that it ends with.
template <class Scalar> void put(std::vector<std::byte>& snapshot, std::size_t at, Scalar number) {
  std::memcpy(snapshot.data() + at, &number, sizeof number);
  Hash sum;
  sum.bytes(snapshot.data(), snapshot.size() - 8);
  const std::uint64_t value = sum.value();
  std::memcpy(snapshot.data() + snapshot.size() - 8, &value, 8);
}

/// How many snapshots are taken that have this number somewhere.
template <class Scalar> int count_taken(Precision precision, Scalar number) {
  World world({precision});
  const BodyId body = must(world.create_body(ball({0, 5, 0})));
  const std::vector<std::byte> snapshot = world.snapshot();
  int taken = 0;
  for (std::size_t at = 0; at + sizeof number <= snapshot.size() - 8; at += sizeof(float)) {
    INFO(double(number) << " at byte " << at);
    std::vector<std::byte> changed = snapshot;
    put(changed, at, number);
    must(world.restore(snapshot));
    if (!world.restore(changed)) continue;
    taken++;
    CHECK(broken_invariant(world.state()) == "");
    CHECK(finite(must(world.velocity(body))));
    CHECK(finite(must(world.angular_velocity(body))));
    Stepper stepper({.sleep = true});
    for (int i = 0; i < 2; i++) (void)stepper.step(world, frame);
    CHECK(length(must(world.pose(body)).orientation) == doctest::Approx(1));
    CHECK(world.restore(world.snapshot()));
  }
  return taken;
}
}  // namespace

TEST_CASE(
    "whatever number stands in the state of a body, it is refused, or the world goes on and its snapshots are whole") {
  for (const float number : {2.0f, 1.0f, -1.0f, 3e38f, 1e-40f}) CHECK(count_taken(Precision::f32, number) > 10);
  for (const double number : {2.0, 1.0, -1.0, 1.7e308, 1e-310}) CHECK(count_taken(Precision::f64, number) > 10);
}

TEST_CASE("an infinite number is refused, or becomes part of another") {
  CHECK(count_taken(Precision::f32, std::numeric_limits<float>::infinity()) > 0);
  CHECK(count_taken(Precision::f64, std::numeric_limits<double>::infinity()) > 0);
}

TEST_CASE("a place beyond the range of numbers is refused") {
  World world({Precision::f64});
  const BodyId body = must(world.create_body(ball({1, 2, 4})));
  std::vector<std::byte> snapshot = world.snapshot();
  const double x = 4;
  const auto at = std::ranges::search(snapshot, std::as_bytes(std::span(&x, 1))).begin() - snapshot.begin();
  put(snapshot, std::size_t(at), 0.9 * constants::largest_state);
  must(world.restore(snapshot));
  CHECK(must(world.pose(body)).position.z == 0.9 * constants::largest_state);
  put(snapshot, std::size_t(at), 10 * constants::largest_state);
  CHECK_REFUSED(world, world.restore(snapshot), ErrorCode::bad_snapshot, "numbers that no step leaves");
}

TEST_CASE("bodies in contact of which one sleeps and one does not are refused") {
  World world;
  must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
  must(world.create_body(ball({0, 0.5, 0})));
  const BodyId upper = must(world.create_body(ball({0, 1.5, 0})));
  Stepper stepper({.sleep = true, .sleep_time = 0.1});
  for (int i = 0; i < 60; i++) REQUIRE(stepper.step(world, frame));
  REQUIRE(must(world.is_asleep(upper)));
  const std::vector<std::byte> snapshot = world.snapshot();
  int refused = 0;
  for (std::size_t at = 0; at + sizeof(float) <= snapshot.size() - 8; at += sizeof(float)) {
    INFO("byte " << at);
    std::vector<std::byte> changed = snapshot;
    put(changed, at, 0.0f);
    if (world.restore(changed))
      CHECK(broken_invariant(world.state()) == "");
    else
      refused++;
  }
  CHECK(refused > 2);
}

TEST_CASE("contacts with numbers that are not finite are refused") {
  World world;
  must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
  must(world.create_body(ball({0, 0.5, 0})));
  Stepper stepper;
  for (int i = 0; i < 5; i++) REQUIRE(stepper.step(world, frame));
  const std::vector<std::byte> snapshot = world.snapshot();
  int taken = 0;
  for (std::size_t at = 0; at + sizeof(float) <= snapshot.size() - 8; at += sizeof(float)) {
    INFO("byte " << at);
    std::vector<std::byte> changed = snapshot;
    put(changed, at, std::numeric_limits<float>::quiet_NaN());
    if (!world.restore(changed)) continue;
    taken++;
    for (const Contact& contact : world.contacts()) {
      CHECK(finite(contact.normal));
      for (const Contact::Point& point : contact.points) CHECK(std::isfinite(point.separation + point.impulse));
    }
  }
  CHECK(taken > 0);  // the features of points are no numbers
}

TEST_CASE("an empty world has a snapshot") {
  World a, b;
  must(b.restore(a.snapshot()));
  CHECK(a.hash() == b.hash());
}
