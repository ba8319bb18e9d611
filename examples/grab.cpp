// A hand drags a ragdoll by its head through a gap that is too narrow for it: the ragdoll stays whole,
// and the hand slips.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pcphys/pcphys.h"

using namespace pcphys;

int main() {
  World world;
  BodyDef floor;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::box({20, 0.5, 20})};
  floor.pose.position = {0, -0.5, 0};
  if (!world.create_body(floor)) return 1;
  for (const double side : {-1.0, 1.0}) {
    BodyDef wall;
    wall.kind = BodyKind::fixed;
    wall.shapes = {ShapeDef::box({0.2, 3, 1})};
    wall.pose.position = {2, 0, 1.04 * side};  // a gap of 8 cm
    if (!world.create_body(wall)) return 1;
  }
  const auto doll = world.create_ragdoll(RagdollDef::human(), {});
  if (!doll) return 1;

  BodyDef hand;
  hand.kind = BodyKind::kinematic;
  hand.shapes = {ShapeDef::sphere(0.02)};
  hand.shapes[0].filter.mask = 0;  // it touches nothing
  hand.pose = *world.pose(doll->bones.back());
  hand.velocity = {2, 0, 0};
  const auto hand_id = world.create_body(hand);
  if (!hand_id) return 1;
  const auto grip = world.grab(*hand_id, doll->bones.back(), hand.pose.position);
  if (!grip) return std::puts(grip.error().message.c_str()), 1;

  Stepper stepper;
  double gap = 0;
  for (int step = 0; step < 180; ++step) {
    if (const StepReport& report = stepper.step(world, 1.0 / 60); !report)
      return std::puts(report.error.message.c_str()), 1;
    for (const JointId joint : doll->joints) gap = std::max(gap, *world.joint_separation(joint));
  }
  const double slipped = *world.joint_separation(*grip);
  std::printf("The hand slipped by %.2f m; the ragdoll's joints were never open by more than %.4f mm.\n", slipped,
              1e3 * gap);
  return slipped > 1 && gap < 1e-4 ? 0 : 1;
}
