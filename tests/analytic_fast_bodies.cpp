// Pins C6: nothing passes through a wall, however fast and thin, straight on or grazing, at any step; what bounces
// without loss keeps its speed to 1 %; two bodies that both move meet; and so does a box full of fast bodies.
#include <algorithm>
#include <random>

#include "support_physics.h"

using namespace physics;

namespace {

enum class Thing { ball5, ball1, box10 };

BodyDef thing(Thing kind, Vec3 position, Vec3 velocity, double restitution) {
  BodyDef def;
  def.shapes = {kind == Thing::box10 ? ShapeDef::box({0.05, 0.05, 0.05})
                                     : ShapeDef::sphere(kind == Thing::ball5 ? 0.05 : 0.01)};
  def.pose.position = position;
  def.velocity = velocity;
  def.material = {0, 0, restitution};
  return def;
}
double reach(Thing kind) { return kind == Thing::box10 ? 0.05 : kind == Thing::ball5 ? 0.05 : 0.01; }

BodyDef wall(Vec3 position, Vec3 half, double restitution = 1) {
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.shapes = {ShapeDef::box(half)};
  def.pose.position = position;
  def.material = {0, 0, restitution};
  return def;
}

struct Shot {
  Thing kind = Thing::ball5;
  double speed = 100, thickness = 0.1, degrees = 0, dt = 1.0 / 60, start = 0.5;  // start: gap in front of the wall [m]
};
struct Outcome {
  bool passed = false;
  double speed_error = 0;   // relative
  double normal_error = 0;  // of the rebound along the wall's normal, relative to the speed
};

/// A wall about x = 0, hit from the left.
Outcome shoot(const Mode& mode, const Shot& s) {
  Run run(mode, {}, 4);
  run.add(wall({0, 0, 0}, {s.thickness / 2, 200, 200}));
  const double angle = s.degrees * std::acos(-1.0) / 180;
  const Vec3 v{s.speed * std::cos(angle), s.speed * std::sin(angle), 0};
  const double side = s.thickness / 2 + reach(s.kind);
  const BodyId id = run.add(thing(s.kind, {-side - s.start, 0, 0}, v, 1));
  const double until = s.start / v.x;
  const long steps = std::lround(until / s.dt) + 4;
  Outcome o;
  for (long i = 0; i < steps; i++) {
    run.step(s.dt);
    o.passed |= run.position(id).x > 0;
  }
  const Vec3 after = *run.world.velocity(id);
  o.speed_error = std::fabs(length(after) - s.speed) / s.speed;
  o.normal_error = std::fabs(after.x + v.x) / s.speed;
  return o;
}

}  // namespace

TEST_CASE("C6: walls of every thickness, speeds, steps, straight and grazing") {
  for (const Mode& mode : precisions()) {
    int runs = 0, passed = 0;
    double worst_speed = 0, worst_normal = 0;
    for (Thing kind : {Thing::ball5, Thing::ball1, Thing::box10})
      for (double speed : {10.0, 100.0, 240.0, 1000.0})
        for (double thickness : {1.0, 0.1, 0.01, 0.001})
          for (double degrees : {0.0, 80.0})
            for (double dt : {1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 1200})
              for (double start : {0.037, 0.5, 1.731}) {
                const Outcome o = shoot(mode, {kind, speed, thickness, degrees, dt, start});
                runs++;
                passed += o.passed;
                worst_speed = std::max(worst_speed, o.speed_error);
                worst_normal = std::max(worst_normal, o.normal_error);
                if (o.passed || o.speed_error > 0.01 || o.normal_error > 0.01)
                  MESSAGE(mode.name() << ": kind " << int(kind) << ", " << speed << " m/s, wall " << thickness << ", "
                                      << degrees << " deg, dt 1/" << 1 / dt << ", start " << start << ": passed "
                                      << o.passed << ", speed " << o.speed_error << ", normal " << o.normal_error);
              }
    MESSAGE("C6 " << mode.name() << ": " << runs << " runs, " << passed << " passed, speed " << worst_speed
                  << ", normal " << worst_normal);
    CHECK(passed == 0);
    CHECK(worst_speed <= 0.01);
  }
}

TEST_CASE("C6: two bodies that both move, head on and off centre") {
  for (const Mode& mode : precisions()) {
    int missed = 0, runs = 0;
    double worst = 0;
    for (double speed : {10.0, 100.0, 240.0, 1000.0})
      for (double offset : {0.0, 0.3, 0.7, 0.95})  // of the sum of the radii
        for (double dt : {1.0 / 60, 1.0 / 240, 1.0 / 1200})
          for (double start : {0.11, 1.3, 4.7}) {
            Run run(mode, {}, 4);
            const double r = 0.05;
            const BodyId a = run.add(thing(Thing::ball5, {-r - start, 0, 0}, {speed, 0, 0}, 1));
            const BodyId b = run.add(thing(Thing::ball5, {r + start, 2 * r * offset, 0}, {-speed, 0, 0}, 1));
            run.step(dt, std::lround((start + 0.1) / speed / dt) + 4);
            const Vec3 v = *run.world.velocity(a), w = *run.world.velocity(b);
            // head on: speeds along the line of centres at impact are exchanged
            const double s = offset, c = std::sqrt(1 - s * s);
            const Vec3 n{c, s, 0};
            const Vec3 expected = Vec3{speed, 0, 0} - (2 * speed * c) * n;
            const double error = std::max(length(v - expected), length(w + expected)) / speed;
            runs++;
            if (length(v - Vec3{speed, 0, 0}) < 1e-6 * speed) missed++;
            worst = std::max(worst, error);
            if (error > 0.01)
              MESSAGE(mode.name() << " " << speed << " m/s, offset " << offset << ", dt 1/" << 1 / dt << ", start "
                                  << start << ": " << error);
          }
    MESSAGE("C6 pairs " << mode.name() << ": " << runs << " runs, " << missed << " missed, error " << worst);
    CHECK(missed == 0);
    CHECK(worst <= 0.01);
  }
}

TEST_CASE("C6: what another sends against a wall that was out of its own reach") {
  for (double dt : {1.0 / 60, 1.0 / 120})
    for (int i = 0; i < 50; i++) {
      Run run({i % 2 ? Precision::f64 : Precision::f32}, {}, 4);
      run.add(wall({0, 0, 0}, {0.01, 100, 100}));
      BodyDef slow = thing(i % 4 < 2 ? Thing::ball5 : Thing::box10, {-1, 0, 0}, {0.1, 0, 0}, 1);
      const BodyId id = run.add(slow);
      run.add(thing(Thing::ball5, {-2 - 0.05 * i, 0.0005 * i, 0}, {300, 0, 0}, 1));
      for (int k = 0; k < 8; k++) {
        run.step(dt);
        CHECK(run.position(id).x < 0);
      }
    }
}

namespace {

/// A closed box of walls 0.2 m thick about the origin, half as wide inside as `half` says, full of fast balls and
/// boxes.
struct Swarm {
  std::vector<BodyId> ids;
  double half;

  Swarm(Run& run, double half_, int count, double speed) : half(half_) {
    const double w = half + 0.1;
    for (int k = 0; k < 3; k++)
      for (double side : {-1.0, 1.0}) {
        const Vec3 at{k == 0 ? side * w : 0, k == 1 ? side * w : 0, k == 2 ? side * w : 0};
        const Vec3 size{k == 0 ? 0.1 : half + 0.2, k == 1 ? 0.1 : half + 0.2, k == 2 ? 0.1 : half + 0.2};
        BodyDef def = wall(at, size, 1);
        def.material = {0.5, 0.5, 0.95};
        run.add(def);
      }
    std::mt19937 random;
    std::uniform_real_distribution<double> uniform(-1, 1), e(0.9, 1), mu(0.5, 1);
    for (int i = 0; i < count; i++) {
      Vec3 direction{uniform(random), uniform(random), uniform(random)};
      direction = (1 / std::max(0.1, length(direction))) * direction;
      BodyDef def;
      def.shapes = {i % 2 ? ShapeDef::box({0.1, 0.1, 0.1}) : ShapeDef::sphere(0.1)};
      def.pose.position = (half - 0.5) * Vec3{uniform(random), uniform(random), uniform(random)};
      def.velocity = speed * direction;
      const double m = mu(random);
      def.material = {m, m, e(random)};
      ids.push_back(run.add(def));
    }
  }
  int outside(const Run& run) const {
    int n = 0;
    for (BodyId id : ids) {
      const Vec3 p = run.position(id);
      n += std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) > half;
    }
    return n;
  }
};

}  // namespace

TEST_CASE("C6: 5000 bodies at 250 m/s in a box of 100 m with thin walls") {
  Run run({Precision::f32}, {0, -gravity, 0}, 4);
  Swarm swarm(run, 50, 5000, 250);
  const double before = run.world.kinetic_energy() + run.world.potential_energy();
  double most = 1;
  for (int i = 0; i < 120; i++) {
    run.step(1.0 / 60);
    most = std::max(most, (run.world.kinetic_energy() + run.world.potential_energy()) / before);
  }
  MESSAGE("C6: " << swarm.outside(run) << " of 5000 outside, energy at most " << most);
  CHECK(swarm.outside(run) == 0);
  CHECK(most <= 1.01);
}

TEST_CASE("C6: a crowd of fast bodies has the same hash in every lane width and on GL") {
  for (Precision precision : {Precision::f64, Precision::f32}) {
    std::vector<std::uint64_t> hashes;
    for (const Mode& mode : everywhere()) {
      if (mode.precision != precision) continue;
      Run run(mode, {0, -gravity, 0}, 4);
      Swarm swarm(run, 3, 60, 100);
      run.step(1.0 / 60, 12);
      CAPTURE(mode.name());
      CHECK(run.world.contact_count() > 0);
      hashes.push_back(run.world.hash());
      CHECK(hashes.back() == hashes.front());
    }
  }
}
