// Joints, ragdolls and forces of a world.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "pcphys/constants.h"
#include "world/state.h"
#include "world/validate.h"

namespace pcphys {
namespace {

double bounded(double angle) { return std::clamp(angle, -constants::free_angle, constants::free_angle); }

void write_joint(Tables& t, std::uint32_t row, const JointDef& d) {
  t.set3(Buffer::joint_frame, row, 0, d.frame_a.position);
  t.set(Buffer::joint_frame, row, 3, double(d.freedom.kind));
  t.set4(Buffer::joint_frame, row, 4, d.frame_a.orientation);
  t.set3(Buffer::joint_frame, row, 8, d.frame_b.position);
  t.set4(Buffer::joint_frame, row, 12, d.frame_b.orientation);
  const AngleFreedom& f = d.freedom;
  Vec3 lower = f.lower, upper = f.upper;
  if (f.kind == AngleFreedom::Kind::cone_twist) {
    lower = {-f.twist, -constants::free_angle, 0};
    upper = {f.twist, f.cone, 0};
  }
  t.set3(Buffer::joint_frame, row, 16, {bounded(lower.x), bounded(lower.y), bounded(lower.z)});
  t.set3(Buffer::joint_frame, row, 20, {bounded(upper.x), bounded(upper.y), bounded(upper.z)});
}

}  // namespace

Status check(JointDef& def) {
  Status ok = check_finite(def.frame_a.position, "pin of a joint in body a");
  if (ok) ok = check_finite(def.frame_b.position, "pin of a joint in body b");
  if (ok) ok = check_unit(def.frame_a.orientation, "frame of a joint in body a");
  if (ok) ok = check_unit(def.frame_b.orientation, "frame of a joint in body b");
  if (ok) ok = check(def.freedom);
  return ok;
}

bool World::valid(JointId joint) const { return state_->joint_ids.valid(joint); }
std::size_t World::joint_count() const { return state_->joint_ids.count(); }

std::vector<JointId> World::joints() const {
  std::vector<JointId> ids;
  for (std::uint32_t i = 0; i < state_->joint_ids.size(); i++)
    if (state_->joint_ids.alive(i)) ids.push_back(state_->joint_ids.id<JointId>(i));
  return ids;
}

Result<JointId> World::create_joint(const JointDef& given) {
  WorldState& s = *state_;
  JointDef def = given;
  if (!valid(def.a) || !valid(def.b)) return stale("body");
  if (def.a == def.b)
    return Error{ErrorCode::bad_joint, "A joint needs two different bodies; use the world's ground() to hold a body in place."};
  const std::uint32_t row_a = s.body_ids.row(def.a.index), row_b = s.body_ids.row(def.b.index);
  if (s.bodies[row_a].kind != BodyKind::dynamic && s.bodies[row_b].kind != BodyKind::dynamic)
    return Error{ErrorCode::bad_joint, "Neither body of the joint is dynamic, so it can do nothing; at least one must be."};
  if (Status ok = check(def); !ok) return ok.error();

  const std::uint32_t row = std::uint32_t(s.joints.size()), index = s.joint_ids.allocate(row);
  s.joints.push_back({index, def.a.index, def.b.index, def});
  s.tables.resize(Table::joint, row + 1);
  write_joint(s.tables, row, def);
  if (!def.collide) s.no_collide[WorldState::pair_key(def.a.index, def.b.index)].joints++;
  s.structure_version++;
  return s.joint_ids.id<JointId>(index);
}

Status World::destroy(JointId joint) {
  WorldState& s = *state_;
  if (!valid(joint)) return stale("joint");
  const std::uint32_t row = s.joint_ids.row(joint.index);
  if (!s.joints[row].def.collide) {
    const auto pair = s.no_collide.find(WorldState::pair_key(s.joints[row].body_a, s.joints[row].body_b));
    pair->second.joints--;
    if (!pair->second.any()) s.no_collide.erase(pair);
  }
  s.remove_row(Table::joint, s.joints, s.joint_ids, row);
  return {};
}

Result<JointDef> World::joint(JointId joint) const {
  if (!valid(joint)) return stale("joint");
  return state_->joints[state_->joint_ids.row(joint.index)].def;
}

Result<double> World::joint_separation(JointId joint) const {
  if (!valid(joint)) return stale("joint");
  const JointRecord& r = state_->joints[state_->joint_ids.row(joint.index)];
  const Pose a = state_->pose(state_->body_ids.row(r.body_a)), b = state_->pose(state_->body_ids.row(r.body_b));
  return length(transform(a, r.def.frame_a.position) - transform(b, r.def.frame_b.position));
}

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
  return joint;
}

Status check(const RagdollDef& def, const Pose& frame, Vec3 velocity) {
  for (std::size_t i = 0; i < def.bones.size(); i++) {
    const BoneDef& bone = def.bones[i];
    if (i > 0 && (bone.parent < 0 || std::size_t(bone.parent) >= i))
      return Error{ErrorCode::bad_joint, "Bone " + std::to_string(i) + " of a ragdoll must have a parent that stands before it."};
    Quat orientation;
    if (const auto mass = check(bone_body(def, bone, frame, velocity), orientation); !mass) return mass.error();
    if (i == 0) continue;
    JointDef joint = bone_joint(def, bone);
    if (Status ok = check(joint); !ok) return ok;
  }
  return {};
}
}  // namespace

Result<Ragdoll> World::create_ragdoll(const RagdollDef& def, const Pose& pose, Vec3 velocity) {
  Pose frame = pose;
  Status ok = check_unit(frame.orientation, "orientation of a ragdoll");
  if (ok) ok = check(def, frame, velocity);  // all of it before anything is made: a refused call uses up no id
  if (!ok) return ok.error();
  Ragdoll made;
  for (const BoneDef& bone : def.bones) {
    Result<BodyId> id = create_body(bone_body(def, bone, frame, velocity));
    if (!id) return id.error();
    made.bones.push_back(*id);
    if (made.bones.size() == 1) continue;
    JointDef joint = bone_joint(def, bone);
    joint.a = made.bones[bone.parent];
    joint.b = *id;
    Result<JointId> joint_id = create_joint(joint);
    if (!joint_id) return joint_id.error();
    made.joints.push_back(*joint_id);
  }
  return made;
}

// ---- forces --------------------------------------------------------------------------------------------

namespace {
ForceId new_force(WorldState& s, ForceRecord record) {
  const std::uint32_t index = s.force_ids.allocate(0);
  if (index == s.forces.size()) s.forces.emplace_back();
  const std::uint32_t row = s.body_ids.row(record.body);
  s.thaw(row);
  if (record.callback) s.callbacks++;
  if (record.callback) s.bring_in_phase(row);  // what it will answer is not known yet
  s.forces[index] = std::move(record);
  std::vector<std::uint32_t>& own = s.bodies[row].forces;
  own.insert(std::ranges::lower_bound(own, index), index);
  s.change_forces(row);
  return s.force_ids.id<ForceId>(index);
}
}  // namespace

Result<ForceId> World::add_force(BodyId body, const Wrench& wrench) {
  if (!valid(body)) return stale("body");
  if (Status ok = check_finite(wrench.force, "force on a body"); !ok) return ok.error();
  if (Status ok = check_finite(wrench.torque, "torque on a body"); !ok) return ok.error();
  return new_force(*state_, {body.index, wrench, {}});
}

Result<ForceId> World::add_force(BodyId body, ForceCallback callback) {
  if (!valid(body)) return stale("body");
  if (!callback) return Error{ErrorCode::bad_argument, "The force callback is empty; pass a function."};
  return new_force(*state_, {body.index, {}, std::move(callback)});
}

Status World::remove(ForceId force) {
  WorldState& s = *state_;
  if (!s.force_ids.valid(force)) return stale("force");
  const std::uint32_t row = s.body_ids.row(s.forces[force.index].body);
  s.thaw(row);
  std::erase(s.bodies[row].forces, force.index);
  s.drop_force(force.index);
  s.change_forces(row);
  return {};
}

}  // namespace pcphys
