// Shapes that pass each other within the seam (two thousandths of their thickness) touch nothing: where they are
// nearest they no longer come together, so nothing holds them. (A sphere that spun at 40 rad/s, 0.2 mm past another,
// was rubbed and lost 8 % of its speed: `pcphys wild passing --seed 515003383`.)
#include "support_world.h"

using namespace worldtest;

TEST_CASE("a sphere that spins past another 0.2 mm away keeps its motion") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({.precision = precision, .gravity = {}});
    must(world.create_body(ball({0, 0, 0}, 0.7615216451509045)));
    BodyDef def = ball({-1.1956359893083572, -0.41932808817364275, -0.18895767303183675}, 0.5193251975652798);
    def.velocity = {-0.09720362722873688, 0.1414453089237213, 0.30976933240890503};
    def.angular_velocity = {22.882842108765523, -33.345207439077285, -5.406770008184269};
    const BodyId body = must(world.create_body(def));
    Stepper stepper;
    for (int i = 0; i < 20; i++) REQUIRE(stepper.step(world, 1.0 / 30));
    CHECK(length(must(world.velocity(body)) - def.velocity) < 1e-6);
  }
}
