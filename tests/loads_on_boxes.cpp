// Pins how far a load presses in what carries it, whatever the ratio of their masses and the steps: by less than a
// fiftieth of its size, on its way down. Once sub-steps were asked for from 200 times its mass on, and a box under 130
// times its own sank by 20 mm of 238 at 1/60 s and by 79 at 1/30 s, and bobbed where steps changed.
#include <algorithm>

#include "support_draws.h"
#include "support_world.h"

using namespace worldtest;
using wild::Dice;

namespace {

/// The deepest that a load comes after it has been put down, over the lower box's size.
double sunk(Dice& dice) {
  World world;
  Stepper stepper;
  const double half = dice.by_ratio(0.02, 1), ratio = dice.by_ratio(1, 200);
  const int pace = dice.one_of(3);  // 1/60 s, 1/30 s, both in turns
  (void)must(world.create_body(fixed_box({0, -1, 0}, {20, 1, 20})));
  BodyDef box;
  box.shapes = {ShapeDef::box({half, half, half})};
  box.density = 200;
  box.pose.position.y = half;
  (void)must(world.create_body(box));
  box.density = 200 * ratio;
  box.pose.position.y = 3 * half;
  const BodyId load = must(world.create_body(box));
  double deepest = 0;
  for (int i = 0; i < 90; i++) {
    const bool longer = pace == 1 || (pace == 2 && i % 2 == 1);
    REQUIRE(stepper.step(world, longer ? 2 * frame : frame));
    deepest = std::max(deepest, 3 * half - world.pose(load)->position.y);
  }
  return deepest / (2 * half);
}

}  // namespace

TEST_CASE("loads on boxes: a box on a box presses it in by less than a fiftieth, whatever the ratio of their masses") {
  const double worst = worst_of("load on a box", 100, sunk);
  MESSAGE("deepest: ", worst);
  CHECK(worst < 0.02);
}
