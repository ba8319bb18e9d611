#include "description.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "world/state.h"

namespace pcphys::peers {
namespace {

using std::numbers::pi;

Wrench constant_wrench(const WorldState& state, std::uint32_t row) {
  Wrench sum;
  for (std::uint32_t index : state.bodies[row].forces) {
    if (state.forces[index].callback) continue;
    sum.force = sum.force + state.forces[index].wrench.force;
    sum.torque = sum.torque + state.forces[index].wrench.torque;
  }
  return sum;
}

Result<Body> read_body(const World& world, BodyId id) {
  const auto row = world.row_of(id);
  if (!row) return row.error();
  Body body;
  const BodyKind kind = *world.kind(id);
  if (kind == BodyKind::kinematic)
    return Error{ErrorCode::unavailable, "Peers have no kinematic bodies: make them fixed, or leave the peers out."};
  body.dynamic = kind == BodyKind::dynamic;
  body.pose = *world.pose(id);
  body.velocity = *world.velocity(id);
  body.angular_velocity = *world.angular_velocity(id);
  body.mass = *world.mass_properties(id);
  body.material = *world.material(id);
  body.shapes = *world.shapes(id);
  body.linear_drag = world.view("linear_drag")->at(*row);
  body.angular_drag = world.view("angular_drag")->at(*row);
  body.wrench = constant_wrench(world.state(), *row);
  return body;
}

/// What no peer does as pcphys does it.
std::vector<std::string> notes(const World& world, const Description& description) {
  std::vector<std::string> result;
  if (world.state().callbacks > 0) result.push_back("forces from callbacks do not act");
  const bool two_frictions = std::any_of(description.bodies.begin(), description.bodies.end(), [](const Body& body) {
    return body.material.static_friction != body.material.kinetic_friction;
  });
  if (two_frictions) result.push_back("static and kinetic friction differ; the kinetic one is used for both");
  const bool asked = std::any_of(world.state().no_collide.begin(), world.state().no_collide.end(),
                                 [](const auto& pair) { return pair.second.asked; });
  if (asked) result.push_back("pairs that set_collide keeps apart do collide");
  return result;
}

}  // namespace

bool AngleRange::free() const { return lower <= -pi && upper >= pi; }

std::array<AngleRange, 3> ranges(const AngleFreedom& freedom) {
  const Vec3 low = freedom.lower, high = freedom.upper;
  return {AngleRange{low.x, high.x}, {low.y, high.y}, {low.z, high.z}};
}

JointKind kind(const AngleFreedom& freedom) {
  if (freedom.kind == AngleFreedom::Kind::free) return JointKind::ball;
  if (freedom.kind == AngleFreedom::Kind::cone_twist) return JointKind::cone_twist;
  const auto [roll, pitch, yaw] = ranges(freedom);
  if (roll.free() && pitch.free() && yaw.free()) return JointKind::ball;
  const auto held = [](AngleRange range) { return range.locked() && range.lower == 0; };
  if (held(pitch) && held(yaw)) return held(roll) ? JointKind::locked : JointKind::hinge;
  return JointKind::angles;
}

Result<Description> Description::of(const World& world, std::span<const BodyId> bodies) {
  Description result;
  result.gravity = world.gravity();
  std::map<BodyId, int> index{{world.ground(), -1}};
  for (BodyId id : bodies) {
    auto body = read_body(world, id);
    if (!body) return body.error();
    index[id] = int(result.bodies.size());
    result.bodies.push_back(std::move(*body));
  }
  if (!world.springs().empty())
    return Error{ErrorCode::unavailable, "Peers are given no springs: leave them or the peers out."};
  for (JointId id : world.joints()) {
    const JointDef def = *world.joint(id);
    if (def.motor.torque > 0 || def.spring.stiffness > 0 || def.yields())
      return Error{ErrorCode::unavailable,
                   "Peers are given no motors, springs and largest forces of joints: leave them or the peers out."};
    if (!index.contains(def.a) || !index.contains(def.b))
      return Error{ErrorCode::unavailable,
                   "A joint holds a body that the peer was not given: list all bodies of the world."};
    result.joints.push_back(
        {index[def.a], index[def.b], def.frame_a, def.frame_b, def.freedom, def.collide, def.spring.damping});
  }
  result.untranslated = notes(world, result);
  return result;
}

bool Description::has_hulls() const {
  return std::ranges::any_of(bodies, [](const Body& body) {
    return std::ranges::any_of(body.shapes, [](const ShapeDef& shape) { return shape.kind == ShapeKind::hull; });
  });
}
bool Description::has_damping() const {
  return std::ranges::any_of(joints, [](const Joint& joint) { return joint.damping > 0; });
}
bool Description::collides(std::size_t body) const {
  const auto& shapes = bodies[body].shapes;
  return std::any_of(shapes.begin(), shapes.end(), [](const ShapeDef& shape) { return shape.filter.mask != 0; });
}

void change_wrench(std::vector<Body>& bodies, std::vector<std::size_t>& pushed, std::size_t body,
                   const Wrench& wrench) {
  bodies[body].wrench = wrench;
  if (bodies[body].dynamic && std::find(pushed.begin(), pushed.end(), body) == pushed.end()) pushed.push_back(body);
}

bool may_touch(const Filter& a, const Filter& b) {
  if (a.group != 0 && a.group == b.group) return a.group > 0;
  return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

HingeAngles hinge_angles(Quat relative) {
  const Vec3 x = rotate(relative, {1, 0, 0}), y = rotate(relative, {0, 1, 0}), z = rotate(relative, {0, 0, 1});
  return {std::atan2(-z.y, y.y), std::atan2(-x.z, x.x), std::asin(std::clamp(x.y, -1.0, 1.0))};
}

}  // namespace pcphys::peers
