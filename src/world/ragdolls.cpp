// Ragdolls of a world: all of their bones and joints, or nothing.
#include <new>
#include <string>

#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

namespace {
BodyDef bone_body(const RagdollDef& def, const BoneDef& bone, const Pose& frame, Vec3 velocity) {
  BodyDef body;
  body.pose = {transform(frame, bone.pose.position), frame.orientation * bone.pose.orientation};
  body.velocity = velocity;
  body.shapes = {bone.shape};
  body.density = def.density;
  body.material = def.material;
  return body;
}

/// Without its bodies.
JointDef bone_joint(const RagdollDef& def, const BoneDef& bone) {
  const Pose &parent = def.bones[bone.parent].pose, &child = bone.pose;
  JointDef joint;
  joint.frame_a = {rotate(conjugate(parent.orientation), bone.joint - parent.position),
                   conjugate(parent.orientation) * bone.joint_axes};
  joint.frame_b = {rotate(conjugate(child.orientation), bone.joint - child.position),
                   conjugate(child.orientation) * bone.joint_axes};
  joint.freedom = bone.freedom;
  joint.spring.damping = bone.damping;
  return joint;
}

Status check(const RagdollDef& def, const Pose& frame, Vec3 velocity) {
  for (std::size_t i = 0; i < def.bones.size(); i++) {
    const BoneDef& bone = def.bones[i];
    if (i > 0 && (bone.parent < 0 || std::size_t(bone.parent) >= i))
      return Error{ErrorCode::bad_joint,
                   "Bone " + std::to_string(i) + " of a ragdoll must have a parent that stands before it."};
    Quat orientation;
    if (const auto mass = check(bone_body(def, bone, frame, velocity), orientation); !mass) return mass.error();
    if (i == 0) continue;
    JointDef joint = bone_joint(def, bone);
    if (Status ok = check(joint); !ok) return ok;
  }
  return {};
}
}  // namespace

namespace {
/// All of it was looked at before.
void add_bones(World& world, const RagdollDef& def, const Pose& frame, Vec3 velocity, Ragdoll& made) {
  const auto count = std::uint32_t(def.bones.size());
  world.state().make_room(count, count, count);
  world.state().drops.make_room(count);
  made.bones.reserve(count);
  made.joints.reserve(count);
  const auto check_memory = [](ErrorCode code) {
    if (code == ErrorCode::buffer_full) throw std::bad_alloc();
  };
  for (const BoneDef& bone : def.bones) {
    const Result<BodyId> body = world.create_body(bone_body(def, bone, frame, velocity));
    if (!body) check_memory(body.error().code);
    made.bones.push_back(*body);
    if (made.bones.size() == 1) continue;
    JointDef joint = bone_joint(def, bone);
    joint.a = made.bones[std::size_t(bone.parent)];
    joint.b = *body;
    const Result<JointId> joined = world.create_joint(joint);
    if (!joined) check_memory(joined.error().code);
    made.joints.push_back(*joined);
  }
}

/// As if they had never been made.
void take_back(WorldState& s, const Ragdoll& made) {
  for (auto joint = made.joints.rbegin(); joint != made.joints.rend(); ++joint) {
    s.remove_joint(s.joint_ids.row(joint->index));
    s.joint_ids.take_back(joint->index);
  }
  for (auto bone = made.bones.rbegin(); bone != made.bones.rend(); ++bone) {
    s.remove_body(s.body_ids.row(bone->index));
    s.body_ids.take_back(bone->index);
  }
}
}  // namespace

Result<Ragdoll> World::create_ragdoll(const RagdollDef& def, const Pose& pose, Vec3 velocity) try {
  Pose frame = pose;
  Status ok = changeable();
  if (ok) ok = check_unit(frame.orientation, "orientation of a ragdoll");
  if (ok) ok = check(def, frame, velocity);  // all of it before anything is made: a refused call uses up no id
  if (!ok) return ok.error();
  Ragdoll made;
  try {
    add_bones(*this, def, frame, velocity, made);
  } catch (...) {
    take_back(state(), made);
    throw;
  }
  return made;
} catch (...) {
  return caught();
}

}  // namespace pcphys
