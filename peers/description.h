// What every engine needs to know of a world, read once, in plain values.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "pcphys/result.h"
#include "pcphys/world.h"

namespace pcphys::peers {

struct Body {
  bool dynamic = true;  // otherwise fixed
  Pose pose;
  Vec3 velocity, angular_velocity;
  MassProperties mass;
  Material material;
  std::vector<ShapeDef> shapes;
  double linear_drag = 0, angular_drag = 0;
  Wrench wrench;  // constant forces

  bool pushed() const { return dynamic && (wrench.force != Vec3{} || wrench.torque != Vec3{}); }
};

/// Bodies by index; -1 is the world.
struct Joint {
  int a = -1, b = -1;
  Pose frame_a, frame_b;
  AngleFreedom freedom;
  bool collide = false;
  double damping = 0;  // of its turning [N m s/rad]
};

/// A range of one angle of a joint [rad].
struct AngleRange {
  double lower = 0, upper = 0;
  bool locked() const { return lower == upper; }
  bool free() const;                                         // no limit on either side within a whole turn
  AngleRange operator-() const { return {-upper, -lower}; }  // the same, seen from the other body
};
/// Roll, pitch and yaw of a joint whose freedom is `pitch_yaw_roll`.
std::array<AngleRange, 3> ranges(const AngleFreedom& freedom);

/// What a joint leaves free, in the terms that other engines have.
enum class JointKind { ball, cone_twist, hinge, locked, angles };
/// A hinge is one whose pitch and yaw are locked at zero.
JointKind kind(const AngleFreedom& freedom);

struct Description {
  Vec3 gravity;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<std::string> untranslated;  // by any peer

  /// Errors: unavailable for kinematic bodies, and for joints with bodies that are not in the list.
  static Result<Description> of(const World& world, std::span<const BodyId> bodies);

  Pose pose_of(int body) const { return body < 0 ? Pose{} : bodies[std::size_t(body)].pose; }
  bool moves(int body) const { return body >= 0 && bodies[std::size_t(body)].dynamic; }
  /// Whether some shape is a hull, which only Bullet is given.
  bool has_hulls() const;
  /// Whether some joint has, which only MuJoCo is given.
  bool has_damping() const;
  /// Whether a body has anything that could touch.
  bool collides(std::size_t body) const;
};

/// What a peer says whose joints have no damping.
inline constexpr const char* no_damping = "joints turn without their damping";

/// Takes a body's new wrench, and lists it among those that are pushed if it is not there.
void change_wrench(std::vector<Body>& bodies, std::vector<std::size_t>& pushed, std::size_t body, const Wrench& wrench);

/// Whether the filters of two shapes let them touch: `Filter` in types.h.
bool may_touch(const Filter& a, const Filter& b);

/// a then b: the frame b, given in a, in a's parent.
inline Pose operator*(const Pose& a, const Pose& b) {
  return {transform(a, b.position), a.orientation * b.orientation};
}
inline Pose inverse(const Pose& p) {
  const Quat q = conjugate(p.orientation);
  return {-rotate(q, p.position), q};
}

/// Roll about x, then yaw about z, then pitch about y: the angles of three hinges, pitch outermost.
struct HingeAngles {
  double roll, pitch, yaw;
};
HingeAngles hinge_angles(Quat relative);

}  // namespace pcphys::peers
