// Pins what small worlds skip: one body, one tree, or contacts that no other stands beside run in one lane, with the
// bits of every width, also when others join them and leave; and bodies that turn about pins alone have no free motion.
#include <algorithm>

#include "support_world.h"

using namespace worldtest;

namespace {

constexpr std::uint32_t widest = 0;  // in one lane where that is enough

/// The hash after each step; a second ball is there from step 60 to step 90.
std::vector<std::uint64_t> hashes(const char* scene, int count, Precision precision, std::uint32_t of_lanes) {
  SceneWorld s = scene_world(scene, count, precision);
  Stepper stepper(lanes(of_lanes));
  BodyDef ball;
  ball.shapes = {ShapeDef::sphere(0.1)};
  ball.pose.position = {0.1, 6, 0.05};
  ball.linear_drag = 0.1;
  std::vector<std::uint64_t> all;
  BodyId other;
  for (int i = 0; i < 120; i++) {
    if (i == 60) other = must(s.world.create_body(ball));
    if (i == 90) REQUIRE(s.world.destroy(other));
    run(s.world, stepper, 1);
    all.push_back(s.world.hash());
  }
  return all;
}

}  // namespace

TEST_CASE("small worlds have the bits of every lane width, also while they grow and shrink") {
  const std::pair<const char*, int> worlds[] = {{"balls", 1}, {"stack", 1}, {"stack", 4}, {"chain", 1},
                                                {"chain", 6}, {"door", 1},  {"heavy", 2}, {"ragdolls", 1}};
  for (const auto& pair : worlds)
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      const char* scene = pair.first;
      const int count = pair.second;
      INFO(scene << " " << count << (precision == Precision::f32 ? ", float" : ", double"));
      const auto own = hashes(scene, count, precision, widest), scalar = hashes(scene, count, precision, 1);
      CHECK(std::ranges::mismatch(own, scalar).in1 == own.end());
      SceneWorld probe = scene_world(scene, count, precision);
      if (Stepper wide(lanes(4)); !step_status(wide, probe.world)) continue;  // the processor has none
      CHECK(hashes(scene, count, precision, 4) == scalar);
    }
}

TEST_CASE("free motion is left out where every body that moves turns about a pin") {
  World world;
  BodyDef rod;
  rod.shapes = {ShapeDef::capsule(0.05, 0.3)};
  JointDef pin;
  pin.a = world.ground();
  pin.b = must(world.create_body(rod));
  pin.frame_b.position = {0, 0.3, 0};
  (void)must(world.create_joint(pin));
  Stepper stepper;
  run(world, stepper, 1);
  const auto runs_advance = [&] {
    return std::ranges::any_of(stepper.plan().entries,
                               [](const PlanEntry& e) { return kernel_name(e).starts_with("advance"); });
  };
  CHECK_FALSE(runs_advance());
  CHECK(std::ranges::any_of(stepper.plan().left_out, [](const LeftOut& l) { return l.what == "free motion"; }));
  BodyDef ball;
  ball.shapes = {ShapeDef::sphere(0.1)};
  ball.pose.position = {5, 0, 0};
  (void)must(world.create_body(ball));
  run(world, stepper, 1);
  CHECK(runs_advance());
}
