// The original's human (section 9.1): 12 capsules, 11 joints, a tree from the hips, standing with its arms
// stretched out and its feet at y = 0. Measures in metres; the axes of a joint point along the child bone.
#include <numbers>

#include "pcphys/types.h"

namespace pcphys {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double quarter = std::numbers::pi / 2;
/// Enough for limbs that hang free to be still within seconds; the humanoids that come with MuJoCo have 0.5 to 5.
constexpr double relaxed = 0.3;  // [N m s/rad]

struct BoneRow {
  int parent;
  Vec3 centre;
  bool level;  // lies along x; else it stands along y
  double radius, half_length;
  Vec3 joint;          // pin to the parent
  Vec3 axis;           // x axis of the joint: twist about it, cone around it
  double cone, twist;  // [degree]
};

constexpr BoneRow rows[] = {
    {-1, {0, 1.05, 0}, true, 0.11, 0.08, {}, {}, 0, 0},                          // hips
    {0, {0, 1.22, 0}, true, 0.10, 0.06, {0, 1.14, 0}, {0, 1, 0}, 25, 20},        // waist
    {1, {0, 1.42, 0}, true, 0.13, 0.09, {0, 1.31, 0}, {0, 1, 0}, 25, 20},        // chest
    {2, {0, 1.72, 0}, false, 0.09, 0.05, {0, 1.57, 0}, {0, 1, 0}, 35, 40},       // head
    {2, {0.39, 1.48, 0}, true, 0.05, 0.10, {0.24, 1.48, 0}, {1, 0, 0}, 80, 45},  // upper arms
    {2, {-0.39, 1.48, 0}, true, 0.05, 0.10, {-0.24, 1.48, 0}, {-1, 0, 0}, 80, 45},
    {4, {0.69, 1.48, 0}, true, 0.045, 0.105, {0.54, 1.48, 0}, {1, 0, 0}, 70, 10},  // forearms
    {5, {-0.69, 1.48, 0}, true, 0.045, 0.105, {-0.54, 1.48, 0}, {-1, 0, 0}, 70, 10},
    {0, {0.11, 0.725, 0}, false, 0.075, 0.15, {0.11, 0.95, 0}, {0, -1, 0}, 60, 20},  // thighs
    {0, {-0.11, 0.725, 0}, false, 0.075, 0.15, {-0.11, 0.95, 0}, {0, -1, 0}, 60, 20},
    {8, {0.11, 0.25, 0}, false, 0.06, 0.19, {0.11, 0.50, 0}, {0, -1, 0}, 65, 10},  // shins
    {9, {-0.11, 0.25, 0}, false, 0.06, 0.19, {-0.11, 0.50, 0}, {0, -1, 0}, 65, 10},
};

/// Turns x to an axis that is +x, -x, +y or -y.
Quat axes_along(Vec3 axis) {
  if (axis.x > 0.5) return {};
  if (axis.x < -0.5) return axis_angle({0, 0, 1}, 2 * quarter);
  return axis_angle({0, 0, 1}, axis.y > 0 ? quarter : -quarter);
}

}  // namespace

RagdollDef RagdollDef::human() {
  RagdollDef def;
  for (const BoneRow& row : rows) {
    BoneDef bone;
    bone.parent = row.parent;
    bone.shape = ShapeDef::capsule(row.radius, row.half_length);
    bone.pose = {row.centre, row.level ? axis_angle({0, 0, 1}, quarter) : Quat{}};
    if (row.parent >= 0) {
      bone.joint = row.joint;
      bone.joint_axes = axes_along(row.axis);
      bone.freedom = AngleFreedom::cone_and_twist(row.cone * degree, row.twist * degree);
      bone.damping = relaxed;
    }
    def.bones.push_back(bone);
  }
  return def;
}

void RagdollDef::set_damping(double damping) {
  for (BoneDef& bone : bones) bone.damping = damping;
}

}  // namespace pcphys
