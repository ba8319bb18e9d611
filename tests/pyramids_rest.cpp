// A pyramid comes to rest, however high. Remembered impulses make soft rows springs, stiffer at rest than in motion,
// and what is so makes energy at low frequencies: one of 60 boxes at its foot went up and down with a period of 0.5 s
// for good (docs/impulses.md, Stiffness).
#include <algorithm>

#include "support_world.h"

using namespace worldtest;

TEST_CASE("a pyramid of boxes does not bounce for good") {
  constexpr int second = 60;
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({precision});
    scenes::SceneOptions options;
    options.count = 40;
    must(scenes::make("pyramid", options, world));
    Stepper stepper;
    const auto most_within = [&](int steps) {
      double most = 0;
      for (int i = 0; i < steps; i++) {
        run(world, stepper, 1);
        most = std::max(most, world.kinetic_energy());
      }
      return most;
    };
    run(world, stepper, second / 2);
    const double early = most_within(second / 2);
    run(world, stepper, 2 * second);
    const double late = most_within(second);
    MESSAGE(precision, ": kinetic energy after half a second ", early, " J, of the fourth second at most ", late, " J");
    CHECK(late < 0.05 * early);
  }
}
