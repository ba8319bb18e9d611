// Pins how overlaps are undone, in random scenes: heavy bodies on light ones are not pressed in far, and what lies in
// each other comes apart without being thrown. Heavy boxes that lay in light ones on the floor were once thrown up by
// 0.19 m, and light ones under several were pressed in by 0.64 of their size.
#include <algorithm>
#include <cmath>
#include <vector>

#include "support_draws.h"
#include "support_world.h"

using namespace worldtest;
using wild::Dice;

namespace {

BodyId add_box(World& world, Vec3 centre, double size, double mass) {
  BodyDef def = fixed_box(centre, {0.5 * size, 0.5 * size, 0.5 * size});
  def.kind = BodyKind::dynamic;
  def.mass = mass;
  return must(world.create_body(def));
}

double height(const World& world, BodyId body) { return world.pose(body)->position.y; }

/// Boxes that get heavier upwards, at steps of two lengths in turns: by how much of a box one is pressed into what is
/// below it at most, from the tenth step on.
double deepest(Dice& dice) {
  const int count = 2 + dice.one_of(5);
  const double size = dice.by_ratio(0.2, 1), ratio = dice.by_ratio(200, 1000);
  World world;
  Stepper stepper;
  (void)must(world.create_body(fixed_box({0, -1, 0}, {20, 1, 20})));
  std::vector<BodyId> boxes;
  for (int i = 0; i < count; i++) {
    const double mass = std::pow(ratio, double(i) / (count - 1));
    boxes.push_back(add_box(world, {0, (i + 0.5) * size, 0}, size, mass));
  }
  double most = 0;
  for (int i = 0; i < 120; i++) {
    REQUIRE(stepper.step(world, i % 2 ? 1.0 / 30 : 1.0 / 60));
    double below = -0.5 * size;
    for (const BodyId box : boxes) {
      const double here = height(world, box);
      if (i >= 10) most = std::max(most, size - (here - below));
      below = here;
    }
  }
  return most / size;
}

/// How far above where it would touch a box comes that lies in a lighter one on the floor [m].
double thrown(Dice& dice) {
  const double size = dice.by_ratio(0.1, 1), depth = dice.between(0.05, 0.4) * size;
  World world;
  Stepper stepper;
  (void)must(world.create_body(fixed_box({0, -1, 0}, {20, 1, 20})));
  (void)add_box(world, {0, 0.5 * size, 0}, size, 1);
  const BodyId heavy = add_box(world, {0, 1.5 * size - depth, 0}, size, dice.by_ratio(2, 300));
  double highest = 0;
  for (int i = 0; i < 240; i++) {
    REQUIRE(stepper.step(world, 1.0 / 60));
    highest = std::max(highest, height(world, heavy));
  }
  return highest - 1.5 * size;
}

}  // namespace

TEST_CASE("overlaps: towers that get heavier upwards are pressed in by less than two hundredths of a box") {
  const double worst = worst_of("heavier upwards", 40, deepest);
  MESSAGE("deepest: ", worst);
  CHECK(worst < 0.02);
}

TEST_CASE("overlaps: a box that lies in a lighter one is not thrown as the two come apart") {
  const double worst = worst_of("lies in a lighter one", 40, thrown);
  MESSAGE("highest: ", worst, " m");
  CHECK(worst < 0.01);
}

TEST_CASE("overlaps: without gravity two boxes come apart, slowly, and their momentum stays zero") {
  World world(WorldDef{.gravity = {}});
  Stepper stepper;
  const BodyId a = add_box(world, {}, 1, 1), b = add_box(world, {0.9, 0, 0}, 1, 5);
  for (int i = 0; i < 300; i++) REQUIRE(stepper.step(world, 1.0 / 60));
  CHECK(world.pose(b)->position.x - world.pose(a)->position.x > 0.999);
  CHECK(length(*world.velocity(a)) < 0.1);
  CHECK(length(world.momentum()) < 1e-6);
}
