#include "builder.h"

namespace pcphys::scenes {

bool Builder::failed(const Error& error) {
  if (error_.code == ErrorCode::none) error_ = error;
  return true;
}

int Builder::add(BodyDef def, int group, int bone) {
  if (error_.code != ErrorCode::none) return -1;
  def.material = material_;
  auto id = world_.create_body(def);
  if (!id && failed(id.error())) return -1;
  scene_.bodies.push_back({*id, def.kind, def.shapes.front(), def.pose, group, bone});
  return int(scene_.bodies.size()) - 1;
}

int Builder::add_fixed_box(Vec3 centre, Vec3 half_extents) {
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.pose.position = centre;
  def.shapes = {ShapeDef::box(half_extents)};
  return add(def);
}

void Builder::add_joint(const JointDef& def) {
  if (error_.code != ErrorCode::none) return;
  auto id = world_.create_joint(def);
  if (!id && failed(id.error())) return;
  scene_.joints.push_back(*id);
}

void Builder::add_ragdoll(const RagdollDef& def, const Pose& pose, Vec3 velocity, int group) {
  if (error_.code != ErrorCode::none) return;
  auto ragdoll = world_.create_ragdoll(def, pose, velocity);
  if (!ragdoll && failed(ragdoll.error())) return;
  for (std::size_t i = 0; i < def.bones.size(); ++i) {
    const BoneDef& bone = def.bones[i];
    const Pose start{transform(pose, bone.pose.position), pose.orientation * bone.pose.orientation};
    scene_.bodies.push_back({ragdoll->bones[i], BodyKind::dynamic, bone.shape, start, group, int(i)});
  }
  scene_.joints.insert(scene_.joints.end(), ragdoll->joints.begin(), ragdoll->joints.end());
}

void Builder::add_floor() {
  add_fixed_box({0, -0.5, 0}, {100, 0.5, 100});
  scene_.floor = 0;
}

void Builder::add_open_box(double inner_width, double wall_height) {
  const double half = 0.5 * inner_width, middle = 0.5 * wall_height;
  add_fixed_box({0, -0.5, 0}, {half + 1, 0.5, half + 1});
  for (double side : {1.0, -1.0}) add_fixed_box({side * (half + 0.5), middle, 0}, {0.5, middle, half + 1});
  for (double side : {1.0, -1.0}) add_fixed_box({0, middle, side * (half + 0.5)}, {half, middle, 0.5});
  scene_.inner_width = inner_width;
  scene_.wall_height = wall_height;
  scene_.floor = 0;
}

}  // namespace pcphys::scenes
