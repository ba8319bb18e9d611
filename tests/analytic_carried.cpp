// What a turning kinematic body carries: its points go along arcs, and what sticks to them does (contact_carried.inl).
#include "support_physics.h"
#include "support_world.h"

using namespace physics;

namespace {

constexpr double radius = 2;  // where the boxes stand [m]

/// A turntable of radius 4 m, its top at 0.
BodyDef turntable(double spin, double friction) {
  BodyDef table;
  table.kind = BodyKind::kinematic;
  table.shapes = {ShapeDef::box({4, 0.5, 4})};
  table.pose.position = {0, -0.5, 0};
  table.angular_velocity = {0, spin, 0};
  table.material = {.static_friction = friction, .kinetic_friction = friction};
  return table;
}
/// A box of 0.5 m that turns along with it.
BodyDef rider(double spin, Vec3 at, double friction) {
  BodyDef box;
  box.shapes = {ShapeDef::box({0.25, 0.25, 0.25})};
  box.mass = 10;
  box.pose.position = at;
  box.angular_velocity = {0, spin, 0};
  box.velocity = cross(box.angular_velocity, {at.x, 0, at.z});
  box.material = {.static_friction = friction, .kinetic_friction = friction};
  return box;
}
double from_axis(const Run& run, BodyId body) {
  const Vec3 p = run.position(body);
  return std::hypot(p.x, p.z);
}
double angle(const Run& run, BodyId body) {
  const Vec3 p = run.position(body);
  return std::atan2(-p.z, p.x);
}

}  // namespace

TEST_CASE("carried: a box that sticks to a turntable stays where it stands") {
  for (const Mode& mode : precisions())
    for (const auto& pair : {std::pair(0.5, 1e-6), {1, 3e-6}, {2, 4e-5}}) {
      const double spin = pair.first, most = pair.second;
      CAPTURE(mode.name());
      CAPTURE(spin);
      Run run(mode, {0, -gravity, 0}, 4);
      run.add(turntable(spin, 2));
      const BodyId box = run.add(rider(spin, {radius, 0.25, 0}, 2));
      run.step(1.0 / 60, 60);
      const double start = from_axis(run, box), ahead = angle(run, box);
      run.step(1.0 / 60, 600);
      CHECK(std::fabs(from_axis(run, box) - start) < most + (mode.is_double() ? 0 : 1e-6));
      CHECK(std::fabs(std::remainder(angle(run, box) - ahead - spin * 10, 6.28318530717958648)) < 1e-5);
      const Vec3 p = run.position(box), on_table = cross({0, spin, 0}, {p.x, 0, p.z});
      CHECK(length(*run.world.velocity(box) - on_table) < 1e-4 * spin * spin * spin * radius);
    }
}

TEST_CASE("carried: what creeps falls with the third power of the sub-step") {
  const auto creep = [](double dt) {
    Run run({Precision::f64}, {0, -gravity, 0}, 4);
    run.add(turntable(2, 2));
    const BodyId box = run.add(rider(2, {radius, 0.25, 0}, 2));
    run.step(dt, std::lround(1 / dt));
    const double start = from_axis(run, box);
    run.step(dt, std::lround(5 / dt));
    return std::fabs(from_axis(run, box) - start);
  };
  const double coarse = creep(1.0 / 60), fine = creep(1.0 / 120);
  CHECK(((coarse < 1e-9 && fine < 1e-9) || order(coarse, fine, 2) > 2.8));
}

TEST_CASE("carried: what stands on a rider, and what hangs together, stays too") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Run run(mode, {0, -gravity, 0}, 4);
    run.add(turntable(1, 2));
    const BodyId low = run.add(rider(1, {radius, 0.25, 0}, 2)), high = run.add(rider(1, {radius, 0.75, 0}, 2));
    const BodyId one = run.add(rider(1, {-radius, 0.25, 0}, 2)), other = run.add(rider(1, {-radius, 0.25, 0.6}, 2));
    JointDef pin;
    pin.a = one;
    pin.b = other;
    pin.frame_a.position = {0, 0, 0.3};
    pin.frame_b.position = {0, 0, -0.3};
    REQUIRE(run.world.create_joint(pin));
    run.step(1.0 / 60, 60);
    std::vector<double> start;
    for (const BodyId body : {low, high, one, other}) start.push_back(from_axis(run, body));
    run.step(1.0 / 60, 600);
    CHECK(std::fabs(from_axis(run, low) - start[0]) < 1e-5);
    CHECK(std::fabs(from_axis(run, high) - start[1]) < 1e-5);
    CHECK(std::fabs(from_axis(run, one) - start[2]) < 2e-4);
    CHECK(std::fabs(from_axis(run, other) - start[3]) < 2e-4);
  }
}

TEST_CASE("carried: what friction cannot hold slides off, and takes the table's speed before") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Run run(mode, {0, -gravity, 0}, 4);
    run.add(turntable(2, 0.5));  // holds up to w^2 r = 4.9 m/s^2, r = 1.23 m
    BodyDef still = rider(0, {1, 0.25, 0}, 0.5);
    const BodyId inner = run.add(still);
    still.pose.position = {0, 0.25, 1.6};
    const BodyId outer = run.add(still);
    run.step(1.0 / 60, 300);
    CHECK(from_axis(run, outer) > 4);
    const Vec3 p = run.position(inner);
    if (from_axis(run, inner) < 1.2) CHECK(length(*run.world.velocity(inner) - cross({0, 2, 0}, {p.x, 0, p.z})) < 1e-2);
  }
}

TEST_CASE("carried: the same bits in all lanes, in threads and on gl") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    worldtest::check_same_bits(
        [&](const StepSettings& settings, int steps) {
          World world({precision, {0, -gravity, 0}});
          REQUIRE(world.create_body(turntable(1.5, 0.8)));
          for (int i = 0; i < 6; i++) {
            const double a = i * 1.04;
            const Vec3 at{radius * std::cos(a), 0.26, radius * std::sin(a)};
            const BodyId low = worldtest::must(world.create_body(rider(1.5, at, 0.8)));
            const BodyId high = worldtest::must(world.create_body(rider(1.5, {at.x, 0.78, at.z}, 0.8)));
            if (i % 2) continue;
            JointDef pin;
            pin.a = low;
            pin.b = high;
            pin.frame_a.position = {0, 0.26, 0};
            pin.frame_b.position = {0, -0.26, 0};
            REQUIRE(world.create_joint(pin));
          }
          Stepper stepper(settings);
          return worldtest::hash_each_step(world, stepper, steps);
        },
        120, 8);
}
