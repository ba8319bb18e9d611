// Pins that a free island keeps its momentum and angular momentum: 1e-12 of the sum of sizes in double, 1e-5
// and 2e-5 in single, over 300 steps of impacts, friction, joints and angle limits.
#include <random>

#include "support_physics.h"

using namespace physics;

namespace {

struct Drift {
  double linear = 0, angular = 0;
};

struct Drifts {
  Drift stored, in_phase;
};

/// Largest change since the start, each step, relative to the sums of sizes at the start.
Drifts run_island(Run& run, long steps = 300) {
  const Momenta start = momenta_in_phase(run.world);
  Drifts worst;
  const auto note = [&](Drift& drift, const Momenta& now) {
    drift.linear = std::max(drift.linear, length(now.linear - start.linear) / start.linear_scale);
    drift.angular = std::max(drift.angular, length(now.angular - start.angular) / start.angular_scale);
  };
  for (long i = 0; i < steps; i++) {
    run.step(1.0 / 60);
    note(worst.stored, momenta_stored(run.world));
    note(worst.in_phase, momenta_in_phase(run.world));
  }
  return worst;
}

void tell(const char* what, const Mode& mode, const Drifts& d) {
  MESSAGE("momentum, " << std::string(what) << ", " << mode.name() << ": stored " << d.stored.linear << " and "
                       << d.stored.angular << ", in phase " << d.in_phase.linear << " and " << d.in_phase.angular);
}

void check(const Mode& mode, const Drift& d) {
  CAPTURE(mode.name());
  CHECK(d.linear <= (mode.is_double() ? 1e-12 : 1e-5));
  CHECK(d.angular <= (mode.is_double() ? 1e-12 : 2e-5));
}

/// Spheres and boxes that fly at the origin and at each other.
void add_cluster(Run& run, double friction, double restitution, double mass_ratio = 1) {
  std::mt19937 random(7);
  const auto between = [&](double low, double high) { return low + (high - low) * (double(random()) / 4294967296.0); };
  for (int i = 0; i < 40; i++) {
    BodyDef def;
    def.material = {friction, friction, restitution};
    const bool box = i % 4 == 3;
    def.shapes = {box ? ShapeDef::box({0.2, 0.15, 0.1}) : ShapeDef::sphere(0.15)};
    def.mass = i % 2 ? 1.0 : mass_ratio;
    def.pose.position = {0.7 * (i % 4) - 1, 0.7 * (i / 4 % 4) - 1, 0.7 * (i / 16) - 0.7};
    def.pose.orientation = exponential({between(-1, 1), between(-1, 1), between(-1, 1)});
    def.velocity = -1.0 * def.pose.position + Vec3{between(-1, 1), between(-1, 1), between(-1, 1)};
    def.angular_velocity = {between(-5, 5), between(-5, 5), between(-5, 5)};
    run.add(def);
  }
}

/// Bones that fly and turn as one rigid body, then tumble.
void add_ragdoll(Run& run) {
  const Vec3 spin{3, 1, -2}, velocity{0.5, 0, -0.2};
  const auto ragdoll = run.world.create_ragdoll(RagdollDef::human(), {{0, -1, 0}, {}});
  REQUIRE(ragdoll);
  for (BodyId bone : ragdoll->bones) {
    REQUIRE(run.world.set_velocity(bone, velocity + cross(spin, run.position(bone))));
    REQUIRE(run.world.set_angular_velocity(bone, spin));
  }
}

void add_chain(Run& run, int links, double last_mass) {
  BodyId above;
  for (int i = 0; i < links; i++) {
    BodyDef def;
    def.shapes = {ShapeDef::capsule(0.05, 0.2)};
    def.shapes[0].filter.mask = 0;
    def.mass = i + 1 == links ? last_mass : 1.0;
    def.pose.position = {0, -0.5 * i, 0};
    def.velocity = {i % 2 ? 1.0 : -1.0, 0, 0.3 * i};
    const BodyId id = run.add(def);
    if (i > 0) {
      JointDef pin;
      pin.a = above;
      pin.b = id;
      pin.frame_a.position = {0, -0.25, 0};
      pin.frame_b.position = {0, 0.25, 0};
      REQUIRE(run.world.create_joint(pin));
    }
    above = id;
  }
}

}  // namespace

TEST_CASE("momentum: bodies that collide") {
  for (const Mode& mode : precisions())
    for (double friction : {0.0, 0.6})
      for (double restitution : {0.0, 0.8}) {
        Run run(mode, {}, 4);
        add_cluster(run, friction, restitution);
        const Drifts d = run_island(run);
        tell(friction > 0 ? "cluster with friction" : "cluster without friction", mode, d);
        CAPTURE(friction);
        CAPTURE(restitution);
        check(mode, d.stored);
        check(mode, d.in_phase);
      }
}

TEST_CASE("momentum: bodies of mass ratio 1:1000 that collide") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {}, 4);
    add_cluster(run, 0.6, 0.5, 1000);
    const Drifts d = run_island(run);
    tell("cluster 1:1000", mode, d);
    check(mode, d.stored);
    check(mode, d.in_phase);
  }
}

TEST_CASE("momentum: bodies that collide, on GL") {
  Run run({Precision::f32, Place::gl}, {}, 4);
  add_cluster(run, 0.6, 0.5);
  const Drifts d = run_island(run, 60);
  tell("cluster, 60 steps", {Precision::f32, Place::gl}, d);
  check({Precision::f32, Place::gl}, d.stored);
}

TEST_CASE("momentum: a free ragdoll tumbles") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {}, 4);
    add_ragdoll(run);
    const Drifts d = run_island(run);
    tell("ragdoll", mode, d);
    check(mode, d.stored);
  }
}

TEST_CASE("momentum: a free chain") {
  for (const Mode& mode : precisions())
    for (double last_mass : {1.0, 1000.0}) {
      Run run(mode, {}, 4);
      add_chain(run, 10, last_mass);
      const Drifts d = run_island(run);
      tell(last_mass > 1 ? "chain 1:1000" : "chain", mode, d);
      CAPTURE(last_mass);
      check(mode, d.stored);
    }
}

// World::momentum and World::angular_momentum tell the stored form, which is exact (above). Velocities in phase with
// positions, as `velocity` and `angular_velocity` read them, are extrapolated by half of what the joints changed in the
// last sub-step, which turns the orbits a little: of second order.
TEST_CASE("momentum: of velocities in phase, a ragdoll, to second order") {
  double errors[3];
  for (int level = 0; level < 3; level++) {
    Run run({Precision::f64}, {}, 4u << level);
    add_ragdoll(run);
    errors[level] = run_island(run, 60).in_phase.angular;
  }
  MESSAGE("momentum in phase, ragdoll: " << errors[0] << ", " << errors[1] << ", " << errors[2]);
  CHECK(errors[0] <= 2e-4);
  CHECK(order(errors[0], errors[2], 4) >= 1.7);
}
