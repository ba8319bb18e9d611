// Pins A1(b), A2, A5 and the free-flight part of A20: motion under constant force, torque and linear drag is
// exact in double at every step length, however steps, sub-steps and forces change on the way.
#include "support_physics.h"

using namespace physics;

namespace {

constexpr double ladder[] = {0.1, 1.0 / 60, 1.0 / 240, 1.0 / 1200, 1e-4};
const Vec3 start_velocity{3, -2, 8}, down{0, 0, -gravity};

/// Position under constant acceleration a and linear drag F after t.
Vec3 with_drag(Vec3 v0, Vec3 a, double drag, double t) {
  const double phi = -std::expm1(-drag * t) / drag;
  return (t / drag) * a + phi * (v0 - (1 / drag) * a);
}
Vec3 without_drag(Vec3 v0, Vec3 a, double t) { return t * v0 + (0.5 * t * t) * a; }

BodyDef ball(double drag = 0) {
  BodyDef def;
  def.shapes = {ShapeDef::sphere(0.1)};
  def.mass = 1;
  def.velocity = start_velocity;
  def.linear_drag = drag;
  return def;
}

/// Largest error over a fall with drag of 5 s.
double drag_error(const Mode& mode, double dt, double seconds = 5) {
  Run run(mode, down);
  const BodyId id = run.add(ball(0.5));
  double worst = 0;
  for (long k = 1, steps = std::lround(seconds / dt); k <= steps; k++) {
    run.step(dt);
    worst = std::max(worst, length(run.position(id) - with_drag(start_velocity, down, 0.5, double(k) * dt)));
  }
  return worst;
}

}  // namespace

TEST_CASE("A1b: a fall with linear drag is exact at every step length, double") {
  for (double dt : ladder) {
    const double error = drag_error({Precision::f64}, dt);
    MESSAGE("A1b f64 dt " << dt << ": " << error << " m");
    CAPTURE(dt);
    CHECK(error <= 1e-11);
  }
}

TEST_CASE("A1b: a fall with linear drag, single") {
  for (double dt : ladder) {
    const double error = drag_error({Precision::f32}, dt);
    MESSAGE("A1b f32 dt " << dt << ": " << error << " m");
    CAPTURE(dt);
    CHECK(error <= 1e-4);
  }
}

TEST_CASE("A1b: a fall with linear drag on every backend and lane width") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    CHECK(drag_error(mode, 0.1, 2) <= (mode.is_double() ? 1e-11 : 1e-4));
    CHECK(drag_error(mode, 1.0 / 60, 1) <= (mode.is_double() ? 1e-11 : 1e-4));
  }
}

TEST_CASE("A2: a projectile is exact at every step length, double") {
  for (double dt : ladder) {
    Run run({Precision::f64}, down);
    const BodyId id = run.add(ball());
    double worst = 0;
    for (long k = 1, steps = std::lround(5 / dt); k <= steps; k++) {
      run.step(dt);
      const Vec3 p = without_drag(start_velocity, down, double(k) * dt);
      worst = std::max(worst, length(run.position(id) - p) / (std::max(length(p), 1.0) * std::sqrt(double(k))));
    }
    MESSAGE("A2 f64 dt " << dt << ": " << worst << " of max(|p|, 1) sqrt(steps)");
    CAPTURE(dt);
    CHECK(worst <= 1e-12);
  }
}

// A velocity in one float alone would take up g h with the rounding of its own last place, the same way each time
// within a binade: 1.1e-5 at 1/1200 s. What is lost is kept, as it is for positions.
TEST_CASE("A2: a projectile of 1200 steps, single") {
  for (double dt : ladder) {
    Run run({Precision::f32}, down);
    const BodyId id = run.add(ball());
    run.step(dt, 1200);
    const Vec3 p = without_drag(start_velocity, down, 1200 * dt);
    const double error = length(run.position(id) - p) / length(p);
    MESSAGE("A2 f32 dt " << dt << ": " << error << " of |p|");
    CAPTURE(dt);
    CHECK(error <= 2e-6);
  }
}

TEST_CASE("A2: a velocity that is set takes half a kick in the first step; a whole one is first order") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    const double dt = 1.0 / 60, tolerance = mode.is_double() ? 1e-14 : 1e-6;
    Run run(mode, down);
    const BodyId id = run.add(ball());
    run.step(dt);
    CHECK(length(run.position(id) - without_drag(start_velocity, down, dt)) <= tolerance);
    // again in mid-flight
    run.step(dt, 9);
    const Vec3 from = run.position(id), v{-4, 1, 2};
    REQUIRE(run.world.set_velocity(id, v));
    CHECK(length(*run.world.velocity(id) - v) <= tolerance);
    run.step(dt);
    const Vec3 moved = run.position(id) - from;
    CHECK(length(moved - without_drag(v, down, dt)) <= tolerance);
    // the naive start p* = p - v dt differs by a dt^2 / 2
    CHECK(length(moved - (dt * v + (dt * dt) * down)) == doctest::Approx(0.5 * gravity * dt * dt).epsilon(1e-3));
  }
}

// ---- A5 ------------------------------------------------------------------------------------------------

namespace {

struct SpinUp {
  double speed_error = 0, angle_error = 0;  // after 10 s
};

/// The box of A4 from rest under 2.6 N m about z, until `seconds_on`, then none, 10 s in all.
SpinUp spin_up(const Mode& mode, double dt, double seconds_on) {
  Run run(mode);
  const BodyId id = run.add(free_body(12, {0.2, 0.4, 0.52}));
  const auto torque = run.world.add_force(id, Wrench{{}, {0, 0, 2.6}});
  REQUIRE(torque);
  const long on = std::lround(seconds_on / dt), all = std::lround(10 / dt);
  run.step(dt, on);
  if (all > on) {
    REQUIRE(run.world.remove(*torque));
    run.step(dt, all - on);
  }
  const double acceleration = 2.6 / 0.52, t1 = double(on) * dt, t2 = double(all - on) * dt;
  const double speed = acceleration * t1, angle = 0.5 * acceleration * t1 * t1 + speed * t2;
  return {length(*run.world.angular_velocity(id) - Vec3{0, 0, speed}),
          angle_between(run.orientation(id), axis_angle({0, 0, 1}, angle))};
}

constexpr double spin_ladder[] = {1.0 / 60, 1.0 / 240, 1.0 / 1200, 1e-4};

}  // namespace

TEST_CASE("A5: constant torque spins a box up exactly, double") {
  for (double dt : spin_ladder) {
    const SpinUp error = spin_up({Precision::f64}, dt, 10);
    MESSAGE("A5 f64 dt " << dt << ": " << error.speed_error << " rad/s, " << error.angle_error << " rad");
    CAPTURE(dt);
    CHECK(error.speed_error <= 1e-9);
    CHECK(error.angle_error <= 1e-8);
  }
}

TEST_CASE("A5: the torque ends at 5 s, double") {
  for (double dt : spin_ladder) {
    const SpinUp error = spin_up({Precision::f64}, dt, 5);
    MESSAGE("A5 off at 5 s, f64 dt " << dt << ": " << error.speed_error << " rad/s, " << error.angle_error << " rad");
    CAPTURE(dt);
    CHECK(error.speed_error <= 1e-9);
    CHECK(error.angle_error <= 1e-8);
  }
}

TEST_CASE("A5: constant torque, single") {
  for (double dt : spin_ladder) {
    const SpinUp on = spin_up({Precision::f32}, dt, 10), off = spin_up({Precision::f32}, dt, 5);
    MESSAGE("A5 f32 dt " << dt << ": " << on.speed_error << " rad/s; off at 5 s " << off.speed_error << " rad/s");
    CAPTURE(dt);
    CHECK(on.speed_error <= 1e-3);
    CHECK(off.speed_error <= 1e-3);
  }
}

TEST_CASE("A5: gravity, a force and drag that change between steps act from that instant") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    const double dt = 1.0 / 60, t = 0.5, tolerance = mode.is_double() ? 1e-12 : 1e-5;
    const Vec3 sideways{0, 5, 0}, push{2, 0, 0};
    Run run(mode, down);
    const BodyId id = run.add(ball());
    run.step(dt, 30);
    Vec3 p = without_drag(start_velocity, down, t), v = start_velocity + t * down;
    REQUIRE(run.world.set_gravity(sideways));
    run.step(dt, 30);
    p = p + without_drag(v, sideways, t), v = v + t * sideways;
    CHECK(length(run.position(id) - p) <= tolerance);
    CHECK(length(*run.world.velocity(id) - v) <= tolerance);
    REQUIRE(run.world.add_force(id, Wrench{push, {}}));
    run.step(dt, 30);
    p = p + without_drag(v, sideways + push, t), v = v + t * (sideways + push);
    CHECK(length(run.position(id) - p) <= tolerance);
    REQUIRE(run.world.set_drag(id, 0.5, 0));
    run.step(dt, 30);
    p = p + with_drag(v, sideways + push, 0.5, t);
    CHECK(length(run.position(id) - p) <= tolerance);
  }
}

// ---- A20, free flight ----------------------------------------------------------------------------------

namespace {

/// Step lengths of A20: 1/60 and 1/240 in turn, or uniform in [0.5, 1.5] / 240.
std::vector<double> step_lengths(bool random) {
  std::vector<double> lengths;
  std::uint32_t state = 20;
  for (double t = 0; t < 5;) {
    state = state * 1664525u + 1013904223u;
    lengths.push_back(random ? (0.5 + double(state >> 8) / 16777216.0) / 240 : lengths.size() % 2 ? 1.0 / 240 : 1.0 / 60);
    t += lengths.back();
  }
  return lengths;
}

double variable_step_error(const Mode& mode, bool random, double drag) {
  Run run(mode, down);
  const BodyId id = run.add(ball(drag));
  double t = 0, worst = 0;
  for (double dt : step_lengths(random)) {
    run.step(dt);
    t += dt;
    const Vec3 p = drag > 0 ? with_drag(start_velocity, down, drag, t) : without_drag(start_velocity, down, t);
    worst = std::max(worst, length(run.position(id) - p));
  }
  return worst;
}

}  // namespace

TEST_CASE("A20: a projectile with steps of changing length stays exact") {
  for (bool random : {false, true}) {
    const double twice = variable_step_error({Precision::f64}, random, 0),
                 single = variable_step_error({Precision::f32}, random, 0);
    MESSAGE("A20 A2 " << std::string(random ? "random" : "alternating") << ": f64 " << twice << " m, f32 " << single << " m");
    CHECK(twice <= 1e-10);
    CHECK(single <= 1e-3);
  }
}

TEST_CASE("A20: a fall with drag with steps of changing length stays exact") {
  for (bool random : {false, true}) {
    const double twice = variable_step_error({Precision::f64}, random, 0.5);
    MESSAGE("A20 A1b " << std::string(random ? "random" : "alternating") << ": f64 " << twice << " m");
    CHECK(twice <= 1e-10);
  }
}

TEST_CASE("A20: the number of sub-steps may change in mid-flight") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    const double dt = 1.0 / 60;
    Run run(mode, down, 4);
    const BodyId id = run.add(ball());
    double worst = 0;
    long k = 0;
    for (std::uint32_t substeps : {4u, 1u, 7u, 2u, 4u}) {
      run.set_substeps(substeps);
      for (int i = 0; i < 5; i++) {
        run.step(dt);
        k++;
        worst = std::max(worst, length(run.position(id) - without_drag(start_velocity, down, double(k) * dt)));
        worst = std::max(worst, length(*run.world.velocity(id) - (start_velocity + (double(k) * dt) * down)));
      }
    }
    CHECK(worst <= (mode.is_double() ? 1e-13 : 2e-5));
  }
}
