// Pins A1(b), A2, A5 and the free-flight part of A20: motion under constant force, torque and linear drag is
// exact in double at every step length, however steps, sub-steps and forces change on the way.
#include "cases/measures.h"
#include "support_cases.h"

using namespace physics;

namespace {

const Vec3 start_velocity{3, -2, 8}, down{0, 0, -gravity};

BodyDef ball(double drag = 0) {
  BodyDef def;
  def.shapes = {ShapeDef::sphere(0.1)};
  def.mass = 1;
  def.velocity = start_velocity;
  def.linear_drag = drag;
  return def;
}

}  // namespace

TEST_CASE("A1b: a fall with linear drag is exact at every step length") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A1", mode, {}, "F"), metric("position"));
}

TEST_CASE("A1b: a fall with linear drag on every backend and lane width") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    check_rows(rows_of("A1", mode, 0.1, "F"), metric("position"));
    check_rows(rows_of("A1", mode, 1.0 / 60, "F"), metric("position"));
  }
}

// A velocity in one float alone would take up g h with the rounding of its own last place, the same way each time
// within a binade: 1.1e-5 at 1/1200 s. What is lost is kept, as it is for positions.
TEST_CASE("A2: a projectile is exact at every step length") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A2", mode));
}

TEST_CASE("A2: a velocity that is set takes half a kick in the first step; a whole one is first order") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    const double dt = 1.0 / 60, tolerance = mode.is_double() ? 1e-14 : 1e-6;
    Run run(mode, down);
    const BodyId id = run.add(ball());
    run.step(dt);
    CHECK(length(run.position(id) - cases::thrown(start_velocity, down, 0, dt)) <= tolerance);
    // again in mid-flight
    run.step(dt, 9);
    const Vec3 from = run.position(id), v{-4, 1, 2};
    REQUIRE(run.world.set_velocity(id, v));
    CHECK(length(*run.world.velocity(id) - v) <= tolerance);
    run.step(dt);
    const Vec3 moved = run.position(id) - from;
    CHECK(length(moved - cases::thrown(v, down, 0, dt)) <= tolerance);
    // the naive start p* = p - v dt differs by a dt^2 / 2
    CHECK(length(moved - (dt * v + (dt * dt) * down)) == doctest::Approx(0.5 * gravity * dt * dt).epsilon(1e-3));
  }
}

// ---- A5 ------------------------------------------------------------------------------------------------

TEST_CASE("A5: constant torque spins a box up exactly, and may end") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A5", mode));
}

TEST_CASE("A5: gravity, a force and drag that change between steps act from that instant") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    const double dt = 1.0 / 60, t = 0.5, tolerance = mode.is_double() ? 1e-12 : 1e-5;
    const Vec3 sideways{0, 5, 0}, push{2, 0, 0};
    Run run(mode, down);
    const BodyId id = run.add(ball());
    run.step(dt, 30);
    Vec3 p = cases::thrown(start_velocity, down, 0, t), v = start_velocity + t * down;
    REQUIRE(run.world.set_gravity(sideways));
    run.step(dt, 30);
    p = p + cases::thrown(v, sideways, 0, t), v = v + t * sideways;
    CHECK(length(run.position(id) - p) <= tolerance);
    CHECK(length(*run.world.velocity(id) - v) <= tolerance);
    REQUIRE(run.world.add_force(id, Wrench{push, {}}));
    run.step(dt, 30);
    p = p + cases::thrown(v, sideways + push, 0, t), v = v + t * (sideways + push);
    CHECK(length(run.position(id) - p) <= tolerance);
    REQUIRE(run.world.set_drag(id, 0.5, 0));
    run.step(dt, 30);
    p = p + cases::thrown(v, sideways + push, 0.5, t);
    CHECK(length(run.position(id) - p) <= tolerance);
  }
}

// ---- A20, free flight ----------------------------------------------------------------------------------

TEST_CASE("A20: projectile and fall with drag stay exact with steps of changing length") {
  for (const Mode& mode : precisions())
    check_rows(rows_of("A20", mode),
               [](const cases::Row& row) { return row.variant.ends_with("A1b") || row.variant.ends_with("A2"); });
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
        worst = std::max(worst, length(run.position(id) - cases::thrown(start_velocity, down, 0, double(k) * dt)));
        worst = std::max(worst, length(*run.world.velocity(id) - (start_velocity + (double(k) * dt) * down)));
      }
    }
    CHECK(worst <= (mode.is_double() ? 1e-13 : 2e-5));
  }
}
