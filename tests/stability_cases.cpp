// Pins what holds of the stiff and extreme cases (docs/stability.md) and is cheap: chains under loads, a tower, bodies
// in one place, degenerate shapes, bad input, crowds on lines and planes.
#include <algorithm>

#include "support_cases.h"

using namespace physics;

namespace {

constexpr double fine = 1.0 / 240;

Where without(std::string start) {
  return [start = std::move(start)](const cases::Row& row) { return !row.metric.starts_with(start); };
}

}  // namespace

TEST_CASE("B1: chains of 10 links hold loads of up to 1e6 links") {
  for (const Mode& mode : precisions()) check_rows(rows_of("B1", mode, fine, "10 links"));
}

TEST_CASE("B3: a box carries 10,000 times its weight, and towers of 10 and a pyramid carry heavy tops") {
  for (const Mode& mode : precisions())
    for (const char* variant : {"two boxes, 1:10000", "tower of 10, top x100", "pyramid of 10, top x300"})
      check_rows(rows_of("B3", mode, fine, variant), without("down"));
}

TEST_CASE("B4: towers of 10 and 30 stand, hardly sink, and their contact forces are the weights") {
  for (const Mode& mode : precisions()) {
    check_rows(rows_of("B4", mode, 1.0 / 60, "10 cubes"));
    check_rows(rows_of("B4", mode, fine, "30 cubes"));
  }
}

TEST_CASE("B9: a house of cards and an arch of 17 stones stand") {
  for (const Mode& mode : precisions()) {
    check_rows(rows_of("B9", mode, fine, "cards"));
    check_rows(rows_of("B9", mode, 1.0 / 60, "arch"));
  }
}

TEST_CASE("C2: what falls and lands does so alike at any size") {
  for (const Mode& mode : precisions())
    for (const char* variant : {"box of 1000 m, e 0", "box of 0.001 m, e 0", "capsule of 100 m, e 0"})
      check_rows(rows_of("C2", mode, fine, variant), metric("path"));
}

TEST_CASE("B12: strong drag ends a motion where it should, and turns nothing round") {
  for (const Mode& mode : precisions()) check_rows(rows_of("B12", mode, {}, "drag"));
}

TEST_CASE("C9: bodies in one place stay finite and repeat") {
  for (const Mode& mode : precisions())
    for (const char* variant : {"2 ", "10 "}) check_rows(rows_of("C9", mode, {}, variant));
}

TEST_CASE("C11, C12: bad input is refused or stays with its body") {
  for (const Mode& mode : precisions()) {
    check_rows(rows_of("C11", mode, {}, "shapes"));
    check_rows(rows_of("C12", mode));
  }
}

TEST_CASE("C14: 100,000 bodies on a line and a plane, pairs as by brute force") {
  for (const char* variant : {"line, sorted", "plane"})
    // no times on a shared machine
    check_rows(rows_of("C14", Mode{Precision::f32}, {}, variant), without("broad phase"));
}

TEST_CASE("C3: thin bodies that land make no energy") {
  for (const Mode& mode : precisions()) {
    for (const char* variant : {"needle, dropped", "disc, dropped", "moments 1:1e4, dropped"})
      check_rows(rows_of("C3", mode, {}, variant), metric("energy above its least before"));
  }
}

TEST_CASE("C5: a box that turns by up to 200 rad a sub-step keeps its energy") {
  for (const Mode& mode : precisions()) check_rows(rows_of("C5", mode, {}, "box"));
}

TEST_CASE("C3: a needle that tumbles and falls from many heights never gains energy") {
  for (const Mode& mode : precisions())
    for (int height = 0; height < 20; ++height) {
      World world({mode.precision, {}});
      Stepper stepper;
      StepSettings settings;
      settings.substeps = 4;
      REQUIRE(stepper.configure(settings));
      REQUIRE(world.set_gravity({0, 0, -9.81}));
      BodyDef floor;
      floor.kind = BodyKind::fixed;
      floor.shapes = {ShapeDef::box({50, 50, 0.5})};
      floor.pose.position = {0, 0, -0.5};
      REQUIRE(world.create_body(floor));
      BodyDef def;
      def.shapes = {ShapeDef::box({0.5, 0.005, 0.005})};
      def.mass = 1;
      def.angular_velocity = {30, 30, 26.46};
      def.pose.position = {0, 0, 1 + 0.003 * height};
      const BodyId needle = *world.create_body(def);
      const auto energy = [&] { return world.kinetic_energy() + 9.81 * world.pose(needle)->position.z; };
      const double start = energy();
      double gained = 0;
      for (int k = 0; k < 300; ++k) {
        REQUIRE(stepper.step(world, 1.0 / 60));
        gained = std::max(gained, energy() / start - 1);
      }
      CHECK(gained < 1e-5);
    }
}

TEST_CASE(
    "B10: a ragdoll pulled by a hand with 15 times its weight holds its joints, and its limits within 5 degrees") {
  for (const Mode& mode : precisions()) check_rows(rows_of("B10", mode, {}, "1e4 N"));
}

TEST_CASE(
    "B10: a ragdoll dragged through a gap stays finite, closes within a second of its end and gains no energy then") {
  for (const Mode& mode : precisions()) check_rows(rows_of("B10", mode, {}, "dragged"));
}
