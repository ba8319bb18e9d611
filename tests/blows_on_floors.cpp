// Pins what a blow does to a body that rests on a floor: it is stopped where it lies. A soft row lets go of a share of
// its impulse; once that was a share of what had just come, too, and a body that was sent down at 20 m/s went on at
// 2.4.
#include <algorithm>

#include "support_draws.h"
#include "support_world.h"

using namespace worldtest;
using wild::Dice;

namespace {

ShapeDef draw_shape(Dice& dice, double radius) {
  switch (dice.one_of(3)) {
    case 0: return ShapeDef::box({radius * dice.between(1, 3), radius, radius * dice.between(1, 3)});
    case 1: return ShapeDef::cylinder(radius * dice.between(1, 3), radius);
    default: return ShapeDef::sphere(radius);
  }
}

/// How deep a body comes into the floor on which it rests, after it was sent down by less than a tenth of its thickness
/// a sub-step (what is faster is struck: docs/impulses.md), as a share of half of its thickness.
double depth(Dice& dice) {
  const double radius = dice.by_ratio(0.1, 1), way = 2 * radius * dice.between(0.01, 0.09);
  World world;
  Stepper stepper;
  (void)must(world.create_body(fixed_box({0, -1, 0}, {20, 1, 20})));
  BodyDef def;
  def.mass = dice.by_ratio(0.1, 10);
  def.pose.position.y = radius;
  def.shapes = {draw_shape(dice, radius)};
  const BodyId body = must(world.create_body(def));
  for (int i = 0; i < 10; i++) REQUIRE(stepper.step(world, frame));
  REQUIRE(world.set_velocity(body, {0, -way * stepper.settings().substeps / frame, 0}));
  double most = 0;
  for (int i = 0; i < 5; i++) {
    REQUIRE(stepper.step(world, frame));
    most = std::max(most, radius - world.pose(body)->position.y);
  }
  return most / radius;
}

}  // namespace

TEST_CASE("blows on floors: what rests on a floor and is sent down stays where it is") {
  const double worst = worst_of("sent down", 200, depth);
  MESSAGE("deepest: ", worst);
  CHECK(worst < 1e-3);
}
