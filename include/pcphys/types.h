// Definition structs: everything that is handed to `create_*`. SI units throughout; angles in radians.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pcphys/hull.h"
#include "pcphys/ids.h"
#include "pcphys/math.h"

namespace pcphys {

enum class Precision : std::uint8_t { f32, f64 };
enum class BodyKind : std::uint8_t {
  fixed,      // never moves; infinite mass ("static" is a keyword)
  kinematic,  // moves with the velocity it was given, whatever it meets
  dynamic
};
enum class ShapeKind : std::uint8_t {
  sphere,    // radius
  capsule,   // radius, half length of the segment; axis = local y
  box,       // half extents (the original's OriBox)
  cylinder,  // radius, half height; axis = local y
  hull,      // a convex polyhedron (pcphys/hull.h)
  plane      // the half space below local y = 0; fixed bodies only
};

/// How the coefficients of two bodies in contact make one. Where the two ask for different rules, the one that stands
/// later in this list holds.
enum class Combine : std::uint8_t { mean, geometric_mean, minimum, product, maximum };

/// How a body answers contacts. Static and kinetic friction and restitution are dimensionless; of two bodies in contact
/// they are combined by rule. Rolling and torsional friction are levers: the contact resists rolling, and turning about
/// its normal, by a couple of up to that length times its load; the larger of the two bodies' holds, 0 is none.
struct Material {
  double static_friction = 0.5;
  double kinetic_friction = 0.5;
  double restitution = 0;
  double rolling_friction = 0;    // [m]
  double torsional_friction = 0;  // [m]
  Combine friction_rule = Combine::geometric_mean;
  Combine restitution_rule = Combine::mean;
};

/// Two shapes collide when each one's category is in the other's mask, unless both have the same
/// non-zero group: then a positive group always collides and a negative one never.
struct Filter {
  std::uint32_t category = 1;
  std::uint32_t mask = 0xffffffffu;
  std::int32_t group = 0;
};

struct ShapeDef {
  ShapeKind kind = ShapeKind::sphere;
  Vec3 size{0.5, 0, 0};  // sphere (radius, -, -), capsule and cylinder (radius, half length, -), box half extents
  Pose local;            // of the shape in its body
  Filter filter;
  Hull convex = {};  // of ShapeKind::hull, which uses no size

  static ShapeDef sphere(double radius) { return {ShapeKind::sphere, {radius, 0, 0}, {}, {}}; }
  static ShapeDef capsule(double radius, double half_length) {
    return {ShapeKind::capsule, {radius, half_length, 0}, {}, {}};
  }
  static ShapeDef box(Vec3 half_extents) { return {ShapeKind::box, half_extents, {}, {}}; }
  static ShapeDef cylinder(double radius, double half_height) {
    return {ShapeKind::cylinder, {radius, half_height, 0}, {}, {}};
  }
  static ShapeDef hull(Hull hull) { return {ShapeKind::hull, {}, {}, {}, std::move(hull)}; }
  static ShapeDef plane() { return {ShapeKind::plane, {}, {}, {}}; }
};

/// Mass [kg] and moments of inertia [kg m^2] about the axes of the body's own frame.
struct MassProperties {
  double mass = 0;
  Vec3 moments;
};

/// A body's frame is its principal frame: origin at the centre of mass, axes along the principal axes.
/// For a single shape that is the shape's own frame; `make_compound` finds it for several.
struct BodyDef {
  BodyKind kind = BodyKind::dynamic;
  Pose pose;
  Vec3 velocity;          // of the centre of mass [m/s]; zero of a fixed body, and so is the next
  Vec3 angular_velocity;  // world axes [rad/s]
  std::vector<ShapeDef> shapes;
  double density = 1000;        // [kg/m^3]; used when `mass` is not given
  std::optional<double> mass;   // [kg]; moments scale with the shapes' own
  std::optional<Vec3> moments;  // [kg m^2]; overrides the shapes' own (then `mass` is needed too)
  Material material;
  double linear_drag = 0;   // F in v' = -F v [1/s]; the original's default is 0.25
  double angular_drag = 0;  // the same of the angular momentum [1/s]
  bool can_sleep = true;    // false: it keeps its island awake (docs/sleeping.md)
  /// false: a dynamic body that no contact, force or spring turns, as if its moments of inertia were infinite; they
  /// read as zero. It takes no joints. Where no body rotates, steps compute no rotation (docs/leaving-out.md).
  bool rotates = true;
};

/// Freedom of b's frame relative to a's. Angles [rad]: roll about the frames' x axis (twist), pitch
/// about y, yaw about z. A freedom with lower = upper is locked; an infinite one is free.
struct AngleFreedom {
  enum class Kind : std::uint8_t {
    free,           // the pin alone
    cone_twist,     // the x axes at most `cone` apart, roll within [-twist, twist]
    pitch_yaw_roll  // the original's angle constraint: each angle within its own interval
  };
  Kind kind = Kind::free;
  double cone = 0, twist = 0;
  Vec3 lower, upper;  // (roll, pitch, yaw)
  /// Of the limits, 0 to 1: the share of its speed at which the joint leaves one that it meets faster than
  /// StepSettings::restitution_threshold, in rad/s here. Not of joints that close a loop (docs/joints.md).
  double restitution = 0;

  static AngleFreedom cone_and_twist(double cone, double twist) { return {Kind::cone_twist, cone, twist, {}, {}}; }
  static AngleFreedom between(Vec3 lower, Vec3 upper) { return {Kind::pitch_yaw_roll, 0, 0, lower, upper}; }
  /// A hinge about the frames' x axis.
  static AngleFreedom hinge(double lower = -std::numeric_limits<double>::infinity(),
                            double upper = std::numeric_limits<double>::infinity()) {
    return between({lower, 0, 0}, {upper, 0, 0});
  }
  static AngleFreedom locked() { return between({}, {}); }
};

/// Turns b against a about the x axis of the joint's frame in a, at `speed`, with at most `torque`: a motor with a gear
/// that does not turn back, which holds its speed (0: a brake) as long as its torque suffices. What the pins leave free
/// may move beside it.
struct Motor {
  double speed = 0;   // [rad/s]
  double torque = 0;  // [N m]; 0: no motor
};

/// Pulls b's frame back to `rest` in a's frame: torque = -stiffness * (rotation vector from rest) - damping * (relative
/// angular velocity). Turns of more than half a circle are taken the short way.
struct AngularSpring {
  double stiffness = 0;  // [N m/rad]
  double damping = 0;    // [N m s/rad]
  Quat rest;
};

/// A spring and damper along the line between a point of a and one of b:
/// tension = stiffness * (distance - rest_length) + damping * (rate of the distance).
/// It pulls and pushes, at any stiffness: what a sub-step is too long to resolve is damped.
struct SpringDef {
  BodyId a, b;              // a may be `World::ground()`
  Vec3 anchor_a, anchor_b;  // in each body's frame [m]
  double rest_length = 0;   // [m]
  double stiffness = 0;     // [N/m]
  double damping = 0;       // [N s/m]
};

/// A pin between two bodies, with an optional angle constraint about the default relative orientation.
struct JointDef {
  BodyId a, b;            // a may be `World::ground()`
  Pose frame_a, frame_b;  // the pin and the joint axes in each body; they coincide in the default pose
  AngleFreedom freedom;
  Motor motor;
  AngularSpring spring;
  bool collide = false;  // whether a and b may collide; adjacent bones do not
  /// Of the pin, above 0; what pulls harder draws it open, and it closes again. Infinite: it never gives way, so a
  /// kinematic body tears what it drags through what stands.
  /// Such a pin is solved as a row, beside the trees ([N]; World::grab).
  double largest_force = std::numeric_limits<double>::infinity();
  bool yields() const { return largest_force < std::numeric_limits<double>::infinity(); }
};

/// One bone of a ragdoll; bone 0 is the root, a parent stands before its children.
struct BoneDef {
  int parent = -1;
  ShapeDef shape;
  Pose pose;        // in the ragdoll's frame, default pose
  Vec3 joint;       // where it is pinned to its parent, ragdoll's frame
  Quat joint_axes;  // of the joint frames, ragdoll's frame
  AngleFreedom freedom;
  /// Torque against the joint's turning, per angular velocity [N m s/rad]; without any, what hangs free swings on.
  double damping = 0;
};

/// A tree of bones (section 9.1 of the original). Adjacent bones do not collide.
struct RagdollDef {
  std::vector<BoneDef> bones;
  double density = 1000;
  Material material;

  /// The original's human: 12 capsules, 11 joints, root at the hips, feet at y = 0.
  /// Its joints have a damping of 0.3 N m s/rad, so that limbs that hang free come to rest.
  static RagdollDef human();
  /// Gives all joints this damping [N m s/rad].
  void set_damping(double damping);
};

struct Ragdoll {
  std::vector<BodyId> bones;    // as in the definition
  std::vector<JointId> joints;  // joints[i] holds bones[i + 1] to its parent
};

/// A force [N] and a torque [N m] acting at a body's centre of mass, world axes.
struct Wrench {
  Vec3 force, torque;
};

}  // namespace pcphys
