// Pins: what the measures of a run say about states whose answer is known by hand.
#include <doctest/doctest.h>

#include <numbers>

#include "scenes/metrics.h"

using namespace pcphys;
using doctest::Approx;

namespace {

struct Built {
  World world;
  scenes::Scene scene;

  explicit Built(const char* name, int count, double ratio = 100) : world({Precision::f64}) {
    scenes::SceneOptions options;
    options.count = count;
    options.ratio = ratio;
    auto made = scenes::make(name, options, world);
    REQUIRE(made);
    scene = *made;
  }
  void put(int body, Vec3 position, Quat orientation = {}) {
    REQUIRE(world.set_pose(scene.bodies[std::size_t(body)].id, {position, orientation}));
  }
  scenes::Metrics measure() const { return scenes::measure(scene, world); }
  double radius(int body) const { return scene.bodies[std::size_t(body)].shape.size.x; }
};

}  // namespace

TEST_CASE("metrics: scenes start without overlap, separation or violated limit, except by rounding") {
  for (const scenes::SceneInfo& info : scenes::list()) {
    CAPTURE(std::string(info.name));
    Built built(info.name.data(), info.default_count);
    const scenes::Metrics metrics = built.measure();
    CHECK(metrics.penetration.max < 1e-9);
    CHECK(metrics.separation.max < 1e-12);
    CHECK(metrics.limit_excess.any < 1e-7);
    CHECK(metrics.escapes.through == 0);
    CHECK(metrics.nonfinite == 0);
    CHECK(metrics.drift.fallen == 0);
  }
}

TEST_CASE("metrics: overlap of balls with each other, floor and walls") {
  Built built("balls", 2);  // bodies 0 to 4 are the box, 5 and 6 the balls
  const double a = built.radius(5), b = built.radius(6);
  built.put(5, {0, 10, 0});
  built.put(6, {0, 10 + a + b - 0.03, 0});
  CHECK(built.measure().penetration.max == Approx(0.03));
  CHECK(built.measure().penetration.count == 1);
  built.put(5, {0, a - 0.02, 0});
  built.put(6, {0, 10, 0});
  CHECK(built.measure().penetration.max == Approx(0.02));
  built.put(5, {0.5 * built.scene.inner_width - a + 0.01, 10, 0});
  built.put(6, {0, 15, 0});
  CHECK(built.measure().penetration.max == Approx(0.01));
  CHECK(built.measure().escapes.through == 0);
  built.put(5, {0.5 * built.scene.inner_width + 0.01, 10, 0});
  built.put(6, {0, -0.01, 0});
  CHECK(built.measure().escapes.through == 2);
  // thrown over the rim, or not
  scenes::RimWatch rim;
  built.put(5, {0, built.scene.wall_height + 1, 0});
  rim.look(built.scene, scenes::poses(built.scene, built.world));
  built.put(5, {built.scene.inner_width, 3, 0});
  rim.look(built.scene, scenes::poses(built.scene, built.world));
  const scenes::Escapes thrown = scenes::escapes(built.scene, scenes::poses(built.scene, built.world), rim);
  CHECK(thrown.through == 1);
  CHECK(thrown.over_the_rim == 1);
  built.put(5, {0, 10, 0});
  rim.look(built.scene, scenes::poses(built.scene, built.world));
  built.put(5, {built.scene.inner_width, 3, 0});
  CHECK(scenes::escapes(built.scene, scenes::poses(built.scene, built.world), rim).through == 2);
}

TEST_CASE("metrics: overlap of capsules that cross, and none of adjacent bones") {
  Built built("ragdolls", 2);
  CHECK(built.measure().penetration.max < 1e-9);
  // the head of one into the head of the other: crossed axes at 0.1 m
  const int head = 5 + 3, other = head + 12;
  built.put(head, {0, 8, 0});
  built.put(other, {0, 8, 0.1}, axis_angle({0, 0, 1}, std::numbers::pi / 2));
  CHECK(built.measure().penetration.max == Approx(2 * 0.09 - 0.1));
  // bones that a joint connects may overlap
  Built adjacent("ragdolls", 1);
  const Pose chest = *adjacent.world.pose(adjacent.scene.bodies[5 + 2].id);
  adjacent.put(5 + 3, chest.position, chest.orientation);
  for (int i : {0, 1}) adjacent.put(5 + i, {0.0, 5.0 + i, 0});
  for (int i = 4; i < 12; ++i) adjacent.put(5 + i, {0.0, 6.0 + i, 0});
  CHECK(adjacent.measure().penetration.max < 1e-9);
}

TEST_CASE("metrics: supports, drift and fall of a stack") {
  Built built("stack", 3);
  const Vec3 top = built.world.pose(built.scene.bodies[3].id)->position;
  built.put(3, top + Vec3{0.1, -0.04, 0});
  scenes::Metrics metrics = built.measure();
  CHECK(metrics.penetration.max == Approx(0.04));
  CHECK(metrics.penetration.count == 1);
  CHECK(metrics.drift.sideways == Approx(0.1));
  CHECK(metrics.drift.down == Approx(0.04));
  CHECK(metrics.drift.fallen == 0);
  built.put(3, {3, 0.5, 0});  // fell beside it
  metrics = built.measure();
  CHECK(metrics.penetration.max < 1e-9);
  CHECK(metrics.drift.fallen == 1);
  built.put(1, {0, 0.5 * std::numbers::sqrt2, 0}, axis_angle({0, 0, 1}, std::numbers::pi / 4));  // on its edge
  CHECK(built.measure().penetration.max < std::numbers::sqrt2);
  CHECK(built.measure().escapes.through == 0);
  built.put(3, {3, -1.5, 0});
  CHECK(built.measure().escapes.through == 1);
}

TEST_CASE("metrics: joint separation") {
  Built built("chain", 1);  // the link hangs on the ground, the load on the link
  const Vec3 load = built.world.pose(built.scene.bodies[1].id)->position;
  built.put(1, load + Vec3{0, 0, 0.25});
  CHECK(built.measure().separation.max == Approx(0.25));
  CHECK(built.measure().separation.mean == Approx(0.125));
}

TEST_CASE("metrics: excess over cone, twist and hinge") {
  const double degree = std::numbers::pi / 180;
  Built built("ragdolls", 1);
  const BodyId chest = built.scene.bodies[5 + 2].id, forearm = built.scene.bodies[5 + 6].id;
  const Pose upper_arm = *built.world.pose(built.scene.bodies[5 + 4].id), fore = *built.world.pose(forearm);
  static_cast<void>(chest);
  // elbow: cone 70, twist 10 degrees about the arm
  const Vec3 along = rotate(upper_arm.orientation, {0, 1, 0});
  const Vec3 across = rotate(upper_arm.orientation, {1, 0, 0});
  built.put(5 + 6, fore.position, axis_angle(across, 75 * degree) * fore.orientation);
  CHECK(built.measure().limit_excess.any == Approx(5 * degree));
  built.put(5 + 6, fore.position, axis_angle(across, 65 * degree) * fore.orientation);
  CHECK(built.measure().limit_excess.any == Approx(0).epsilon(1e-7));
  built.put(5 + 6, fore.position, axis_angle(along, -13 * degree) * fore.orientation);
  CHECK(built.measure().limit_excess.any == Approx(3 * degree));

  Built door("door", 1);
  const Pose shut = *door.world.pose(door.scene.bodies[1].id);
  door.put(1, shut.position, axis_angle({0, 1, 0}, 100 * degree) * shut.orientation);  // free to swing
  CHECK(door.measure().limit_excess.any < 1e-7);
  door.put(1, shut.position, axis_angle({1, 0, 0}, 7 * degree) * shut.orientation);
  CHECK(door.measure().limit_excess.any == Approx(7 * degree));
}

TEST_CASE("metrics: energy and momentum of a known state") {
  Built built("balls", 1);
  const BodyId ball = built.scene.bodies[5].id;
  const double m = built.world.mass_properties(ball)->mass;
  REQUIRE(built.world.set_pose(ball, {{0, 3, 0}, {}}));
  REQUIRE(built.world.set_velocity(ball, {1, 2, -2}));
  const scenes::Metrics metrics = built.measure();
  CHECK(metrics.kinetic == Approx(4.5 * m));
  CHECK(metrics.potential == Approx(m * 9.81 * 3));
  CHECK(metrics.momentum.y == Approx(2 * m));
}
