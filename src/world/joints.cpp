// Joints and springs of a world.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>

#include "pcphys/constants.h"
#include "world/state.h"
#include "world/union_find.h"
#include "world/validate.h"

namespace pcphys {
namespace {

double bounded(double angle) { return std::clamp(angle, -constants::free_angle, constants::free_angle); }

}  // namespace

void write_frames(Tables& t, Buffer buffer, std::uint32_t row, const JointDef& d) {
  t.set3(buffer, row, 0, d.frame_a.position);
  t.set(buffer, row, 3, double(d.freedom.kind));
  t.set4(buffer, row, 4, d.frame_a.orientation);
  t.set3(buffer, row, 8, d.frame_b.position);
  t.set(buffer, row, 11, d.yields() ? d.largest_force : 0);
  t.set4(buffer, row, 12, d.frame_b.orientation);
  const AngleFreedom& f = d.freedom;
  Vec3 lower = f.lower, upper = f.upper;
  if (f.kind == AngleFreedom::Kind::cone_twist) {
    lower = {-f.twist, -constants::free_angle, 0};
    upper = {f.twist, f.cone, 0};
  }
  t.set3(buffer, row, 16, {bounded(lower.x), bounded(lower.y), bounded(lower.z)});
  t.set3(buffer, row, 20, {bounded(upper.x), bounded(upper.y), bounded(upper.z)});
  t.set(buffer, row, 23, f.restitution);
}

namespace {

enum class Drive { none, of_joint, between_points };

void write_drive(Tables& t, std::uint32_t row, const JointRecord& joint) {
  const JointDef& d = joint.def;
  t.set4(Buffer::joint_drive, row, 0, d.spring.rest);
  t.set(Buffer::joint_drive, row, 4, d.motor.speed);
  t.set(Buffer::joint_drive, row, 5, d.motor.torque);
  t.set(Buffer::joint_drive, row, 6, joint.spring ? joint.spring->stiffness : d.spring.stiffness);
  t.set(Buffer::joint_drive, row, 7, joint.spring ? joint.spring->damping : d.spring.damping);
  const Drive kind = joint.spring ? Drive::between_points : joint.driven() ? Drive::of_joint : Drive::none;
  t.set(Buffer::joint_drive, row, 8, double(kind));
  t.set(Buffer::joint_drive, row, 9, joint.spring ? joint.spring->rest_length : 0);
}

void stir_ends(WorldState& s, const JointRecord& joint) {
  for (const std::uint32_t body : {joint.body_a, joint.body_b}) s.stir_moving(s.body_ids.row(body));
}

/// Also what the plan needs may change: whether there is anything to drive at all.
template <class Change> void change_drive(WorldState& s, std::uint32_t row, Change change) {
  JointRecord& joint = s.joints[row];
  const bool before = joint.driven();
  change(joint);
  write_drive(s.tables, row, joint);
  if (joint.driven() != before) s.structure_version++, s.joint_changes++;
  stir_ends(s, joint);
}

}  // namespace

Status check(JointDef& def) {
  Status ok = check_finite(def.frame_a.position, "pin of a joint in body a");
  if (ok) ok = check_finite(def.frame_b.position, "pin of a joint in body b");
  if (ok) ok = check_unit(def.frame_a.orientation, "frame of a joint in body a");
  if (ok) ok = check_unit(def.frame_b.orientation, "frame of a joint in body b");
  if (ok) ok = check(def.freedom);
  if (ok) ok = check(def.motor);
  if (ok) ok = check(def.spring);
  if (ok && !(def.largest_force > 0))
    ok = Error{ErrorCode::bad_joint,
               "The largest force of a joint must be above 0 [N], or infinite: then its pin never gives way."};
  if (ok && def.yields()) ok = check_finite(def.largest_force, "largest force of a joint");
  return ok;
}

namespace {
// joints and springs share rows and indices
template <class AnyId> bool is_alive(const WorldState& s, AnyId id, bool spring) {
  return s.joint_ids.valid(id) && s.joints[s.joint_ids.row(id.index)].spring.has_value() == spring;
}
template <class AnyId> std::vector<AnyId> all_alive(const WorldState& s, bool spring) {
  std::vector<AnyId> ids;
  for (std::uint32_t i = 0; i < s.joint_ids.size(); i++)
    if (s.joint_ids.alive(i) && s.joints[s.joint_ids.row(i)].spring.has_value() == spring)
      ids.push_back(s.joint_ids.id<AnyId>(i));
  return ids;
}
}  // namespace

bool World::valid(JointId joint) const { return is_alive(state(), joint, false); }
bool World::valid(SpringId spring) const { return is_alive(state(), spring, true); }
std::vector<JointId> World::joints() const try { return all_alive<JointId>(state(), false); } catch (...) {
  detail::no_memory_for("World::joints");
}
std::vector<SpringId> World::springs() const try { return all_alive<SpringId>(state(), true); } catch (...) {
  detail::no_memory_for("World::springs");
}

std::size_t World::joint_count() const {
  return state().joints.size() - 1 - state().springs;  // row 0 pads
}

namespace {
Status check_ends(const World& world, BodyId a, BodyId b, const char* what) {
  const WorldState& s = world.state();
  if (!world.valid(a) || !world.valid(b)) return stale("body");
  if (a == b)
    return Error{
        ErrorCode::bad_joint,
        std::string("A ") + what + " needs two different bodies; use the world's ground() to hold a body in place."};
  if (s.bodies[s.body_ids.row(a.index)].kind != BodyKind::dynamic &&
      s.bodies[s.body_ids.row(b.index)].kind != BodyKind::dynamic)
    return Error{ErrorCode::bad_joint, std::string("Neither body of the ") + what +
                                           " is dynamic, so it can do nothing; at least one must be."};
  return {};
}

std::uint32_t new_row(WorldState& s, const JointDef& def, const std::optional<SpringDef>& spring) {
  s.make_room(0, 1, 0);
  const auto joints_of = [&](BodyId body) -> std::vector<std::uint32_t>& {
    return s.bodies[s.body_ids.row(body.index)].joints;
  };
  for (const BodyId body : {def.a, def.b}) make_room(joints_of(body));
  if (!def.collide) s.no_collide[WorldState::pair_key(def.a.index, def.b.index)].joints++;
  // nothing needs memory from here on
  const std::uint32_t row = std::uint32_t(s.joints.size()), index = s.joint_ids.allocate(row);
  s.joints.push_back({index, def.a.index, def.b.index, def, spring});
  s.springs += spring.has_value();
  s.tables.resize(Table::joint, row + 1);
  write_frames(s.tables, Buffer::joint_frame, row, def);
  write_drive(s.tables, row, s.joints[row]);
  for (const BodyId body : {def.a, def.b}) joints_of(body).push_back(index);
  s.structure_version++, s.joint_changes++;
  stir_ends(s, s.joints[row]);
  return index;
}
}  // namespace

Result<JointId> World::create_joint(const JointDef& given) try {
  JointDef def = given;
  Status ok = changeable();
  if (ok) ok = check_ends(*this, def.a, def.b, "joint");
  if (ok) ok = check(def);
  for (const BodyId body : {def.a, def.b})
    if (ok && !state().rotates(state().body_ids.row(body.index)))
      ok = Error{ErrorCode::bad_joint,
                 "A body that does not rotate (BodyDef::rotates) takes no joint; create one that does, or a spring."};
  if (!ok) return ok.error();
  return state().joint_ids.id<JointId>(new_row(state(), def, {}));
} catch (...) {
  return caught();
}

namespace {
/// Of all that hangs together with a body by joints [kg].
double mass_of_all(const WorldState& s, std::uint32_t row) {
  UnionFind joined(s.bodies.size());
  for (const JointRecord& joint : s.joints) {
    const std::uint32_t a = s.body_ids.row(joint.body_a), b = s.body_ids.row(joint.body_b);
    if (!joint.spring && s.responds(a) && s.responds(b)) joined.join(a, b);
  }
  double sum = 0;
  for (std::uint32_t at = 1; at < s.bodies.size(); at++)
    if (joined.root(at) == joined.root(row)) sum += s.tables.get(Buffer::mass, at, 3);
  return sum;
}
}  // namespace

Result<JointId> World::grab(BodyId hand, BodyId body, Vec3 point) try {
  Status ok = changeable();
  if (ok) ok = check_finite(point, "point of a grab");
  if (ok && (!valid(hand) || !valid(body))) ok = stale("body");
  if (!ok) return ok.error();
  const WorldState& s = state();
  const std::uint32_t a = s.body_ids.row(hand.index), b = s.body_ids.row(body.index);
  if (s.bodies[a].kind != BodyKind::kinematic || s.bodies[b].kind != BodyKind::dynamic)
    return Error{ErrorCode::bad_joint, "A hand that grabs is a kinematic body, and what it grabs a dynamic one."};
  constexpr double earth = 9.81, times = 100;
  const double g = length(s.gravity) > 0 ? length(s.gravity) : earth;
  const auto seen_from = [&](std::uint32_t row) {
    return rotate(conjugate(s.pose(row).orientation), point - s.pose(row).position);
  };
  JointDef def;
  def.a = hand;
  def.b = body;
  def.frame_a.position = seen_from(a);
  def.frame_b.position = seen_from(b);
  def.largest_force = times * g * mass_of_all(s, b);
  return create_joint(def);
} catch (...) {
  return caught();
}

Result<SpringId> World::create_spring(const SpringDef& def) try {
  Status ok = changeable();
  if (ok) ok = check_ends(*this, def.a, def.b, "spring");
  if (ok) ok = check(def);
  if (!ok) return ok.error();
  JointDef ends;
  ends.a = def.a;
  ends.b = def.b;
  ends.frame_a.position = def.anchor_a;
  ends.frame_b.position = def.anchor_b;
  ends.collide = true;
  return state().joint_ids.id<SpringId>(new_row(state(), ends, def));
} catch (...) {
  return caught();
}

void WorldState::remove_joint(std::uint32_t row) {
  stir_ends(*this, joints[row]);
  springs -= joints[row].spring.has_value();
  if (!joints[row].def.collide) {
    const auto pair = no_collide.find(pair_key(joints[row].body_a, joints[row].body_b));
    pair->second.joints--;
    if (!pair->second.any()) no_collide.erase(pair);
  }
  for (const std::uint32_t body : {joints[row].body_a, joints[row].body_b}) {
    std::vector<std::uint32_t>& of_body = bodies[body_ids.row(body)].joints;
    const auto last = std::ranges::find(of_body.rbegin(), of_body.rend(), joints[row].index);
    if (last != of_body.rend()) of_body.erase(std::prev(last.base()));
  }
  remove_row(Table::joint, joints, joint_ids, row);
  joint_changes++;
}

Status World::destroy(JointId joint) try {
  if (Status ok = changeable(joint); !ok) return ok;
  state().remove_joint(state().joint_ids.row(joint.index));
  return {};
} catch (...) {
  return caught();
}

Status World::destroy(SpringId spring) try {
  if (Status ok = changeable(spring); !ok) return ok;
  state().remove_joint(state().joint_ids.row(spring.index));
  return {};
} catch (...) {
  return caught();
}

Status World::set_motor(JointId joint, const Motor& motor) try {
  if (Status ok = changeable(joint); !ok) return ok;
  if (Status ok = check(motor); !ok) return ok;
  change_drive(state(), state().joint_ids.row(joint.index), [&](JointRecord& r) { r.def.motor = motor; });
  return {};
} catch (...) {
  return caught();
}

Status World::set_spring(JointId joint, const AngularSpring& given) try {
  if (Status ok = changeable(joint); !ok) return ok;
  AngularSpring spring = given;
  if (Status ok = check(spring); !ok) return ok;
  change_drive(state(), state().joint_ids.row(joint.index), [&](JointRecord& r) { r.def.spring = spring; });
  return {};
} catch (...) {
  return caught();
}

Status World::set_spring(SpringId spring, double rest_length, double stiffness, double damping) try {
  if (Status ok = changeable(spring); !ok) return ok;
  const std::uint32_t row = state().joint_ids.row(spring.index);
  SpringDef def = *state().joints[row].spring;
  def.rest_length = rest_length;
  def.stiffness = stiffness;
  def.damping = damping;
  if (Status ok = check(def); !ok) return ok;
  change_drive(state(), row, [&](JointRecord& r) { r.spring = def; });
  return {};
} catch (...) {
  return caught();
}

Result<SpringDef> World::spring(SpringId spring) const try {
  if (!valid(spring)) return stale("spring");
  return *state().joints[state().joint_ids.row(spring.index)].spring;
} catch (...) {
  return caught();
}

double World::spring_energy() const {
  const WorldState& s = state();
  double sum = 0;
  for (const JointRecord& r : s.joints) {
    if (!r.driven()) continue;
    const Pose a = s.pose(s.body_ids.row(r.body_a)), b = s.pose(s.body_ids.row(r.body_b));
    if (r.spring) {
      const double x =
          length(transform(a, r.spring->anchor_a) - transform(b, r.spring->anchor_b)) - r.spring->rest_length;
      sum += 0.5 * r.spring->stiffness * x * x;
      continue;
    }
    const Quat q = conjugate(a.orientation * r.def.frame_a.orientation) * b.orientation * r.def.frame_b.orientation *
                   conjugate(r.def.spring.rest);
    const double angle = 2 * std::atan2(std::hypot(q.x, q.y, q.z), std::fabs(q.w));
    sum += 0.5 * r.def.spring.stiffness * angle * angle;
  }
  return sum;
}

Result<JointDef> World::joint(JointId joint) const try {
  if (!valid(joint)) return stale("joint");
  return state().joints[state().joint_ids.row(joint.index)].def;
} catch (...) {
  return caught();
}

Result<double> World::joint_separation(JointId joint) const try {
  if (!valid(joint)) return stale("joint");
  const JointRecord& r = state().joints[state().joint_ids.row(joint.index)];
  const Pose a = state().pose(state().body_ids.row(r.body_a)), b = state().pose(state().body_ids.row(r.body_b));
  return length(transform(a, r.def.frame_a.position) - transform(b, r.def.frame_b.position));
} catch (...) {
  return caught();
}

}  // namespace pcphys
