// Pins the lists of forces and torques: constants add up and go, callbacks are asked once a step before
// anything moves and may read the world, a callback that fails leaves the world alone.
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "support_world.h"
#include "world/state.h"

using namespace worldtest;

namespace {

BodyDef unit_body(Vec3 position) {
  BodyDef def;
  def.mass = 2;
  def.moments = Vec3{1, 2, 2};
  def.pose.position = position;
  return def;
}

Vec3 stored(const World& world, BodyId body, const char* property) {
  const PropertyView v = must(world.view(property));
  const std::uint32_t row = must(world.row_of(body));
  return {v.at(row, 0), v.at(row, 1), v.at(row, 2)};
}

/// The magnet of the original: pulls a body towards a place, by a law of the distance, within a reach.
Wrench magnet(const World& world, BodyId body, Vec3 place, double strength, double reach) {
  const Vec3 d = place - world.pose(body)->position;
  const double r = length(d);
  if (r > reach || r < 1e-6) return {};
  return {(strength / (r * r)) * ((1 / r) * d), {}};
}

}  // namespace

TEST_CASE("constant forces: they add up, act, and go one by one") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world(WorldDef{precision, {}});
    const BodyId body = must(world.create_body(unit_body({}))), other = must(world.create_body(unit_body({10, 0, 0})));
    const ForceId first = must(world.add_force(body, Wrench{{1, 0, 0}, {}})),
                  second = must(world.add_force(body, Wrench{{1, 2, 0}, {0.5, 0, 0}}));
    CHECK(stored(world, body, "force") == Vec3{2, 2, 0});
    CHECK(stored(world, body, "torque") == Vec3{0.5, 0, 0});
    CHECK(stored(world, other, "force") == Vec3{});
    Stepper stepper;
    run(world, stepper, 60);
    const Vec3 v = must(world.velocity(body)), w = must(world.angular_velocity(body));
    const double tolerance = precision == Precision::f32 ? 1e-5 : 1e-12;
    CHECK(length(v - Vec3{1, 1, 0}) < tolerance);    // F t / m
    CHECK(length(w - Vec3{0.5, 0, 0}) < tolerance);  // T t / I
    CHECK(length(must(world.pose(body)).position - Vec3{0.5, 0.5, 0}) < tolerance);
    CHECK(must(world.velocity(other)) == Vec3{});
    must(world.remove(first));
    CHECK(stored(world, body, "force") == Vec3{1, 2, 0});
    must(world.remove(second));
    CHECK(stored(world, body, "force") == Vec3{});
    CHECK(stored(world, body, "torque") == Vec3{});
    CHECK_REFUSED(world, world.remove(second), ErrorCode::stale_id, "This id names no force of the world");
    run(world, stepper, 60);
    CHECK(length(must(world.velocity(body)) - v) < tolerance);  // they act until the instant they go
  }
}

TEST_CASE("forces follow a body to another row") {
  World world(WorldDef{Precision::f32, {}});
  const BodyId first = must(world.create_body(unit_body({}))), last = must(world.create_body(unit_body({10, 0, 0})));
  const ForceId force = must(world.add_force(last, Wrench{{4, 0, 0}, {}}));
  int calls = 0;
  const ForceId callback = must(world.add_force(last, [&](const World&, BodyId body) {
    CHECK(body == last);
    calls++;
    return Wrench{{0, 4, 0}, {}};
  }));
  must(world.destroy(first));
  Stepper stepper;
  run(world, stepper, 60);
  CHECK(calls == 60);
  CHECK(length(must(world.velocity(last)) - Vec3{2, 2, 0}) < 1e-5);
  must(world.remove(callback));
  must(world.remove(force));
  run(world, stepper, 1);
  CHECK(calls == 60);
  CHECK(stored(world, last, "force") == Vec3{});
}

TEST_CASE("constant forces of many bodies: sums in ascending order of force indices, whatever came and went") {
  struct Added {
    ForceId id;
    std::size_t body;
    Wrench wrench;
  };
  World world(WorldDef{Precision::f64, {}});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 12; i++) bodies.push_back(must(world.create_body(unit_body({3.0 * i, 0, 0}))));
  std::map<std::uint32_t, Added> forces;  // by index
  for (int round = 0; round < 600; round++) {
    const std::size_t b = random() % bodies.size();
    if (round % 3 == 2 && !forces.empty()) {
      const auto gone = std::next(forces.begin(), long(random() % forces.size()));
      must(world.remove(gone->second.id));
      forces.erase(gone);
    } else if (round % 50 == 10) {  // its forces go with it, and the last row moves
      must(world.destroy(bodies[b]));
      std::erase_if(forces, [&](const auto& f) { return f.second.body == b; });
      bodies[b] = must(world.create_body(unit_body({3.0 * double(b), 0, 0})));
    } else {
      const Wrench wrench{{any(random), any(random), any(random)}, {any(random), any(random), any(random)}};
      const ForceId id = must(world.add_force(bodies[b], wrench));
      CHECK(forces.emplace(id.index, Added{id, b, wrench}).second);
    }
    for (std::size_t k = 0; k < bodies.size(); k++) {
      Vec3 force, torque;
      for (const auto& [index, f] : forces)
        if (f.body == k) force = force + f.wrench.force, torque = torque + f.wrench.torque;
      CHECK(stored(world, bodies[k], "force") == force);
      CHECK(stored(world, bodies[k], "torque") == torque);
    }
  }
}

TEST_CASE("callbacks: a magnet that depends on the distance") {
  // the same trajectory by the scheme's own formula: p' = 2 p - p_last + h^2 a(p at the step's start)
  World world(WorldDef{Precision::f64, {}});
  const Vec3 place{0, 1, 0};
  const BodyId body = must(world.create_body(unit_body({2, 0, 0})));
  int calls = 0;
  (void)must(world.add_force(body, [&](const World& w, BodyId id) {
    calls++;
    return magnet(w, id, place, 3, 2.5);
  }));
  const BodyId beyond = must(world.create_body(unit_body({0, 9, 0})));
  (void)must(world.add_force(beyond, [&](const World& w, BodyId id) { return magnet(w, id, place, 3, 2.5); }));
  Stepper stepper;
  Vec3 p{2, 0, 0}, v;
  const double h = frame / 4;
  bool first = true;
  for (int step = 0; step < 30; step++) {
    const Vec3 d = place - p;
    const double r = length(d);
    const Vec3 a = (3 / (r * r * r) / 2) * d;
    for (int k = 0; k < 4; k++) {
      v = v + (first ? 0.5 * h : h) * a;
      first = false;
      p = p + h * v;
    }
    run(world, stepper, 1);
  }
  CHECK(calls == 30);
  CHECK(length(must(world.pose(body)).position - p) < 1e-11);
  CHECK(length(p - Vec3{2, 0, 0}) > 0.03);
  CHECK(must(world.pose(beyond)).position == Vec3{0, 9, 0});
}

TEST_CASE("callbacks and constants add up; a callback may go at any time") {
  World world(WorldDef{Precision::f64, {}});
  const BodyId body = must(world.create_body(unit_body({})));
  (void)must(world.add_force(body, Wrench{{2, 0, 0}, {}}));
  const ForceId up = must(world.add_force(body, [](const World&, BodyId) { return Wrench{{0, 2, 0}, {}}; }));
  const ForceId turning = must(world.add_force(body, [](const World&, BodyId) {
    return Wrench{{0, 0, 2}, {0, 4, 0}};
  }));
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(stored(world, body, "force") == Vec3{2, 2, 2});
  CHECK(stored(world, body, "torque") == Vec3{0, 4, 0});
  must(world.remove(up));
  run(world, stepper, 1);
  CHECK(stored(world, body, "force") == Vec3{2, 0, 2});
  must(world.remove(turning));
  CHECK(stored(world, body, "force") == Vec3{2, 0, 0});
  CHECK(stored(world, body, "torque") == Vec3{});
}

TEST_CASE("callbacks see the world as it was before the step, whatever their order") {
  World world(WorldDef{Precision::f64, {}});
  const BodyId a = must(world.create_body(unit_body({}))), b = must(world.create_body(unit_body({1, 0, 0})));
  std::vector<Vec3> seen;
  const auto spring = [&](BodyId other) {
    return [&, other](const World& w, BodyId id) {
      seen.push_back(stored(w, other, "force"));
      return Wrench{w.pose(other)->position - w.pose(id)->position, {}};
    };
  };
  (void)must(world.add_force(a, spring(b)));
  (void)must(world.add_force(b, spring(a)));
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(seen == std::vector<Vec3>{{}, {}});
  run(world, stepper, 1);
  CHECK(seen.at(2) == Vec3{-1, 0, 0});
  CHECK(seen.at(3) == Vec3{1, 0, 0});
  CHECK(length(stored(world, a, "force") - Vec3{1, 0, 0}) < 1e-2);
  CHECK(stored(world, a, "force") == -stored(world, b, "force"));
  CHECK(length(world.momentum()) < 1e-15);
}

TEST_CASE("a callback that is not finite: a named error, and the world as it was") {
  World world;
  const BodyId a = must(world.create_body(unit_body({}))), b = must(world.create_body(unit_body({3, 0, 0})));
  bool broken = false;
  (void)must(world.add_force(a, [&](const World&, BodyId) { return Wrench{{broken ? 7.0 : 1.0, 0, 0}, {}}; }));
  (void)must(world.add_force(b, [&](const World&, BodyId) {
    return Wrench{{broken ? std::nan("") : 1.0, 0, 0}, {0, broken ? 1.0 : 0, 0}};
  }));
  Stepper stepper;
  run(world, stepper, 2);
  broken = true;
  CHECK_REFUSED(world, step_status(stepper, world), ErrorCode::not_finite,
                "The force of a callback of body 2 is (nan, 0, 0)");
  broken = false;
  run(world, stepper, 1);
}
