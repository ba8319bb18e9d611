// Pins what velocities mean where a host reads and writes them: in phase with positions to second order in
// flight, zero at rest, the original's last position and orientation as round trips, and positions as sums
// of two reals that keep slow motion far from the origin.
#include "support_physics.h"

using namespace physics;

namespace {
const Vec3 down{0, -gravity, 0};
}

TEST_CASE("velocity: read back to second order under a force that changes with position") {
  // a spring of 2 rad/s: x = cos 2t, v = -2 sin 2t
  double errors[3];
  for (int level = 0; level < 3; level++) {
    const double dt = 1.0 / (30 << level);
    Run run({Precision::f64});
    BodyDef def = free_body(2, {1, 1, 1});
    def.pose.position = {1, 0, 0};
    const BodyId id = run.add(def);
    REQUIRE(run.world.add_force(id, [](const World& world, BodyId body) {
      return Wrench{-8.0 * world.pose(body)->position, {}};
    }));
    run.step(dt, 30 << level);
    errors[level] = std::fabs(run.world.velocity(id)->x + 2 * std::sin(2.0));
  }
  MESSAGE("velocity read-back, spring: " << errors[0] << ", " << errors[1] << ", " << errors[2] << " m/s");
  CHECK(order(errors[0], errors[1], 2) >= 1.9);
  CHECK(order(errors[1], errors[2], 2) >= 1.9);
}

TEST_CASE("velocity: read back exactly in free flight, with drag and without") {
  for (int level = 0; level < 3; level++)
    for (double drag : {0.0, 3.0, 100.0}) {
      const double dt = 1.0 / (30 << level);
      CAPTURE(dt);
      CAPTURE(drag);
      Run run({Precision::f64}, down);
      BodyDef def = free_body(1, {1, 1, 1}, {4, 0, 0});
      def.linear_drag = drag;
      const BodyId id = run.add(def);
      run.step(dt);
      const auto exact = [&](double t) {
        return drag > 0 ? Vec3{4 * std::exp(-drag * t), gravity / drag * std::expm1(-drag * t), 0}
                        : Vec3{4, -gravity * t, 0};
      };
      CHECK(length(*run.world.velocity(id) - exact(dt)) <= 1e-12);
      run.step(dt, (30 << level) - 1);
      CHECK(length(*run.world.velocity(id) - exact(1)) <= 1e-12);
    }
}

namespace {

/// What a body on the floor reads after four seconds.
void rest(const Mode& mode, const ShapeDef& shape, double height, double& speed, double& spin) {
  Run run(mode, down, 4);
  BodyDef floor;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::plane()};
  run.add(floor);
  BodyDef def;
  def.shapes = {shape};
  def.pose.position = {0.3, height + 0.05, -0.2};
  const BodyId id = run.add(def);
  run.step(1.0 / 60, 240);
  speed = length(*run.world.velocity(id));
  spin = length(*run.world.angular_velocity(id));
}

}  // namespace

TEST_CASE("velocity: a body at rest on the floor reads exactly zero") {
  for (const Mode& mode : precisions()) {
    for (bool box : {true, false}) {
      double speed, spin;
      rest(mode, box ? ShapeDef::box({0.3, 0.2, 0.25}) : ShapeDef::sphere(0.25), box ? 0.2 : 0.25, speed, spin);
      CAPTURE(mode.name());
      CHECK(speed == 0);
      CHECK(spin == 0);
    }
  }
}

TEST_CASE("last position and orientation: what is written is read, and the next step goes on from it") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    const double dt = 1.0 / 60, tolerance = mode.is_double() ? 1e-14 : 1e-6;
    Run run(mode, down);
    BodyDef def = free_body(2, {0.3, 0.3, 0.3}, {1, 2, 3});
    def.pose = {{5, -3, 2}, exponential({0.4, -0.2, 0.7})};
    const BodyId id = run.add(def);
    CHECK_FALSE(run.world.position_last(id));  // there is no sub-step yet
    run.step(dt);
    const Vec3 p = run.position(id), last = p - Vec3{0.03, 0.01, -0.02};
    const Quat q = run.orientation(id), turn = exponential({0.05, 0.02, -0.11}), q_last = conjugate(turn) * q;
    REQUIRE(run.world.set_position_last(id, last));
    REQUIRE(run.world.set_orientation_last(id, q_last));
    CHECK(length(*run.world.position_last(id) - last) <= tolerance);
    CHECK(angle_between(*run.world.orientation_last(id), q_last) <= tolerance);
    run.step(dt);
    // the original's Verlet step: p + (p - p_last) + a dt^2, and the same rotation again
    CHECK(length(run.position(id) - (2 * p - last + (dt * dt) * down)) <= tolerance);
    CHECK(angle_between(run.orientation(id), turn * q) <= tolerance);
    CHECK(length(*run.world.position_last(id) - p) <= tolerance);
    CHECK(angle_between(*run.world.orientation_last(id), q) <= tolerance);
  }
}

TEST_CASE("last orientation: a double cover's other sign, and a half turn nearly done, are read right") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Run run(mode);
    const BodyId id = run.add(free_body(1, {0.2, 0.2, 0.2}));
    run.step(0.01);
    for (double angle : {1e-7, 1e-3, 1.0, 3.1}) {
      CAPTURE(angle);
      const Quat back = exponential({0, 0, -angle}), other{-back.x, -back.y, -back.z, -back.w};
      for (const Quat& last : {back, other}) {
        REQUIRE(run.world.set_orientation_last(id, last));
        CHECK(run.world.angular_velocity(id)->z == doctest::Approx(angle / 0.01).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("two-real position: single precision moves at 1 mm/s, 1 km from the origin") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    const long steps = mode.place == Place::gl ? 30 : 600;
    Run run(mode, {}, 4);
    BodyDef def = free_body(1, {1, 1, 1}, {1e-3, 0, -1e-3});
    def.pose.position = {1000, 10, -1000};
    const BodyId id = run.add(def);
    run.step(1.0 / 60, steps);
    const double way = 1e-3 * double(steps) / 60;
    const Vec3 moved = run.position(id) - def.pose.position;
    if (mode.place == Place::cpu)
      MESSAGE("1 mm/s at 1 km, " << mode.name() << ": off by " << length(moved - Vec3{way, 0, -way}) / way
                                 << " of the way");
    // a single float's last place is 6.1e-5 m there, 15 times the way of a sub-step
    CHECK(length(moved - Vec3{way, 0, -way}) <= 1e-6 * way);
  }
}
