// A ragdoll, and one of its own making: the human of the library, and a snake of capsules, fall onto a floor.
#include <algorithm>
#include <cstdio>
#include <numbers>

#include "pcphys/pcphys.h"

using namespace pcphys;

namespace {

RagdollDef snake(int bones) {
  RagdollDef def;
  for (int i = 0; i < bones; ++i) {
    BoneDef bone;
    bone.parent = i - 1;
    bone.shape = ShapeDef::capsule(0.08, 0.12);
    bone.pose = {{0.45 * i, 0, 0}, axis_angle({0, 0, 1}, std::numbers::pi / 2)};
    bone.joint = {0.45 * i - 0.225, 0, 0};
    if (i > 0) bone.freedom = AngleFreedom::cone_and_twist(0.8, 0.3);
    def.bones.push_back(bone);
  }
  return def;
}

}  // namespace

int main() {
  World world;
  BodyDef floor;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::plane()};
  if (!world.create_body(floor)) return 1;
  const auto human = world.create_ragdoll(RagdollDef::human(), {{0, 1, 0}, {}});
  const auto own = world.create_ragdoll(snake(6), {{-1, 1, 2}, axis_angle({0, 0, 1}, 0.4)}, {0, 1, 0});
  if (!human || !own) return 1;

  Stepper stepper;
  for (int step = 0; step < 300; ++step)
    if (const StepReport& report = stepper.step(world, 1.0 / 60); !report)
      return std::puts(report.error.message.c_str()), 1;

  double apart = 0, lowest = 1;
  for (JointId joint : world.joints()) apart = std::max(apart, *world.joint_separation(joint));
  for (const Ragdoll& ragdoll : {*human, *own})
    for (BodyId bone : ragdoll.bones) lowest = std::min(lowest, world.pose(bone)->position.y);
  std::printf("%zu bones, %zu joints; joints at most %.3f mm apart, lowest bone at %.3f m\n", world.body_count() - 1,
              world.joint_count(), 1000 * apart, lowest);
  return apart < 0.01 && lowest > 0.02 ? 0 : 1;
}
