#include "world/validate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "pcphys/constants.h"
#include "pcphys/world.h"

namespace pcphys {
namespace {

bool sane(double x) { return std::isfinite(x) && std::fabs(x) <= constants::largest_input; }

Status check_extent(double x, const char* what) {
  if (!std::isfinite(x))
    return Error{ErrorCode::not_finite,
                 std::string("The ") + what + " of a shape is not a number; give it a finite length in metres."};
  if (x < constants::smallest_extent || x > constants::largest_extent)
    return Error{ErrorCode::degenerate_shape, std::string("The ") + what + " of a shape is " + number(x) +
                                                  " m; it must lie between " + number(constants::smallest_extent) +
                                                  " and " + number(constants::largest_extent) + " m."};
  return {};
}

}  // namespace

const char* name(ErrorCode code) {
  constexpr const char* names[] = {
      "none",        "not_finite",  "bad_mass",     "degenerate_shape", "not_unit_quaternion", "bad_time_step",
      "stale_id",    "bad_joint",   "bad_argument", "unknown_name",     "name_taken",          "wrong_type",
      "unavailable", "buffer_full", "device_error", "bad_file",         "bad_snapshot",        "busy"};
  return names[int(code)];
}

namespace detail {
void misuse(const char* sentence) {
  std::fprintf(stderr, "pcphys: %s\n", sentence);
  std::abort();
}
void no_value(const Error& error) {
  misuse(("The value of a Result was taken, which holds an error in its place: " + std::string(name(error.code)) +
          ". " + error.message)
             .c_str());
}
void no_error() { misuse("The error of a Result was asked for, which holds none: it succeeded."); }
void moved_from(const char* what, const char* call) {
  misuse((std::string(what) + "::" + call + " was called on a " + what +
          " that was moved from; use the one that it was moved to, or assign another to it first.")
             .c_str());
}
}  // namespace detail

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

Error stale(const char* what) {
  return {ErrorCode::stale_id,
          std::string("This id names no ") + what + " of the world: it was destroyed, or never created here."};
}

// so short that it stands in the string itself
Error no_memory() { return {ErrorCode::buffer_full, "Out of memory."}; }

Error caught() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  } catch (const std::exception& e) {
    detail::misuse((std::string("A fault of the library, which should be reported: ") + e.what()).c_str());
  }
  return no_memory();
}

namespace detail {
namespace {
const std::shared_ptr<const Error> kept_no_memory = std::make_shared<const Error>(no_memory());
}
std::shared_ptr<const Error> keep(Error error) noexcept {
  try {
    return std::make_shared<const Error>(std::move(error));
  } catch (...) {
    return kept_no_memory;
  }
}
void no_memory_for(const char* call) {
  std::fprintf(stderr, "pcphys: There is no memory for what %s answers.\n", call);
  std::abort();
}
}  // namespace detail

Error busy(const char* what) {
  return {ErrorCode::busy,
          std::string("A step of this ") + what +
              " runs; callbacks may look at the world, not change it. Do this when Stepper::step has returned."};
}

Error no_rotation() {
  return {ErrorCode::bad_argument,
          "The body does not rotate (BodyDef::rotates), so it has no angular velocity; create one that does."};
}

Status check_moves(BodyKind kind, Vec3 value, const char* what) {
  if (kind != BodyKind::fixed || value == Vec3{}) return {};
  return Error{ErrorCode::bad_argument, std::string("A fixed body has no ") + what + "; make it kinematic to move it."};
}

Status check_finite(double value, const char* what) {
  if (!sane(value))
    return Error{ErrorCode::not_finite, std::string("The ") + what + " is " + number(value) +
                                            "; it must be finite and no larger than " +
                                            number(constants::largest_input) + "."};
  return {};
}

Status check_finite(Vec3 value, const char* what) {
  if (!sane(value.x) || !sane(value.y) || !sane(value.z))
    return Error{ErrorCode::not_finite, std::string("The ") + what + " is (" + number(value.x) + ", " +
                                            number(value.y) + ", " + number(value.z) +
                                            "); every component must be finite and no larger than " +
                                            number(constants::largest_input) + "."};
  return {};
}

Status check_spin(Vec3 moments, Vec3 angular_velocity) {
  const double most = std::max({moments.x, moments.y, moments.z}) * length(angular_velocity);
  if (most <= constants::largest_momentum) return {};
  return Error{ErrorCode::not_finite, "The angular momentum of a body would be up to " + number(most) +
                                          " kg m^2/s; it must be no larger than " +
                                          number(constants::largest_momentum) +
                                          ". Give the body a smaller spin first, or smaller moments of inertia."};
}

Status check_unit(Quat& value, const char* what) {
  if (!finite(value))
    return Error{ErrorCode::not_finite,
                 std::string("The ") + what + " holds NaN or infinity; give a unit quaternion (x, y, z, w)."};
  const double l = length(value);
  if (std::fabs(l - 1) > constants::unit_tolerance)
    return Error{ErrorCode::not_unit_quaternion, std::string("The ") + what + " has length " + number(l) +
                                                     "; normalise it: a rotation is a unit quaternion (x, y, z, w)."};
  value = {value.x / l, value.y / l, value.z / l, value.w / l};
  return {};
}

Status check(const ShapeDef& shape) {
  if (shape.kind > ShapeKind::plane)
    return Error{ErrorCode::bad_argument,
                 "A shape is of no known kind; use ShapeDef::sphere, capsule, box, cylinder, hull or plane."};
  Status ok;
  if (shape.kind == ShapeKind::hull && !shape.convex)
    ok = Error{ErrorCode::degenerate_shape,
               "A shape of kind hull has none; make one with make_hull and pass it to ShapeDef::hull."};
  if (ok && shape.kind != ShapeKind::hull && shape.kind != ShapeKind::plane)
    ok = check_extent(shape.size.x, shape.kind == ShapeKind::box ? "half extent x" : "radius");
  if (ok && shape.kind == ShapeKind::box) ok = check_extent(shape.size.y, "half extent y");
  if (ok && shape.kind == ShapeKind::box) ok = check_extent(shape.size.z, "half extent z");
  if (ok && (shape.kind == ShapeKind::capsule || shape.kind == ShapeKind::cylinder))
    ok = check_extent(shape.size.y, "half length");
  if (ok) ok = check_finite(shape.size, "size of a shape");  // also what its kind does not use
  if (ok) ok = check_finite(shape.local.position, "local position of a shape");
  Quat q = shape.local.orientation;
  if (ok) ok = check_unit(q, "local orientation of a shape");
  return ok;
}

Status check(const Material& m) {
  for (double x : {m.static_friction, m.kinetic_friction, m.restitution, m.rolling_friction, m.torsional_friction})
    if (!sane(x))
      return Error{ErrorCode::not_finite, "A coefficient of friction or restitution is not a number, or larger than " +
                                              number(constants::largest_input) + "; give finite ones."};
  if (m.static_friction < 0 || m.kinetic_friction < 0)
    return Error{ErrorCode::bad_argument, "A coefficient of friction is below zero; use 0 for none."};
  if (m.rolling_friction < 0 || m.torsional_friction < 0)
    return Error{ErrorCode::bad_argument,
                 "The rolling or torsional friction is below zero; it is a length [m], 0 for none."};
  if (m.friction_rule > Combine::maximum || m.restitution_rule > Combine::maximum)
    return Error{ErrorCode::bad_argument,
                 "A rule of friction or restitution is none that there is; use Combine::mean, geometric_mean, minimum, "
                 "product or "
                 "maximum."};
  if (m.restitution < 0 || m.restitution > 1)
    return Error{ErrorCode::bad_argument, "The restitution is " + number(m.restitution) +
                                              "; it must lie between 0 (no bounce) and 1 (no loss)."};
  return {};
}

Status check(const MassProperties& given, bool rotates) {
  MassProperties m = given;
  if (!rotates) m.moments = {1, 1, 1};
  if (!std::isfinite(m.mass) || !finite(m.moments))
    return Error{ErrorCode::not_finite, "The mass or a moment of inertia is not a number; give finite ones."};
  if (!(m.mass > 0))
    return Error{ErrorCode::bad_mass,
                 "The mass is " + number(m.mass) +
                     " kg; a dynamic body's must be above zero. Use BodyKind::fixed for a body that never moves."};
  const Vec3 i = m.moments;
  if (!(i.x > 0 && i.y > 0 && i.z > 0))
    return Error{ErrorCode::bad_mass, "A moment of inertia is not above zero; all three must be."};
  const double low = constants::smallest_mass, high = constants::largest_mass;
  for (double x : {m.mass, i.x, i.y, i.z})
    if (x < low || x > high)
      return Error{ErrorCode::bad_mass, "A mass or moment of inertia is " + number(x) + "; it must lie between " +
                                            number(low) + " and " + number(high) + " (kg, kg m^2)."};
  const double slack = 1 + constants::moment_tolerance;
  if (i.x > (i.y + i.z) * slack || i.y > (i.x + i.z) * slack || i.z > (i.x + i.y) * slack)
    return Error{ErrorCode::bad_mass, "The moments of inertia (" + number(i.x) + ", " + number(i.y) + ", " +
                                          number(i.z) +
                                          ") belong to no body: none may exceed the sum of the other two."};
  return {};
}

namespace {
/// Mass and moments of a dynamic body: as given, or from its one shape.
Result<MassProperties> mass_of(const BodyDef& def) {
  if (def.moments) {
    if (!def.mass)
      return Error{ErrorCode::bad_mass, "Moments of inertia are given without a mass; give both, or neither."};
    return MassProperties{*def.mass, *def.moments};
  }
  if (def.shapes.empty())
    return Error{ErrorCode::bad_mass, "A dynamic body without shapes needs a mass and moments of inertia."};
  if (def.shapes.size() > 1 || def.shapes[0].local != Pose{})
    return Error{ErrorCode::bad_mass,
                 "A body's frame is its principal frame; pass a body of several or displaced shapes through "
                 "make_compound first, "
                 "or give mass and moments."};
  Result<MassProperties> m = mass_properties(def.shapes[0], def.density);
  if (!m || !def.mass) return m;
  const double scale = *def.mass / m->mass;
  return MassProperties{*def.mass, scale * m->moments};
}
}  // namespace

Result<MassProperties> check(const BodyDef& def, Quat& orientation) {
  orientation = def.pose.orientation;
  Status ok;
  if (def.kind > BodyKind::dynamic)
    ok = Error{ErrorCode::bad_argument, "A body is of no known kind; use BodyKind::fixed, kinematic or dynamic."};
  if (ok) ok = check_finite(def.pose.position, "position of a body");
  if (ok) ok = check_unit(orientation, "orientation of a body");
  if (ok) ok = check_finite(def.velocity, "velocity of a body");
  if (ok) ok = check_finite(def.angular_velocity, "angular velocity of a body");
  if (ok) ok = check_moves(def.kind, def.velocity, "velocity");
  if (ok) ok = check_moves(def.kind, def.angular_velocity, "angular velocity");
  if (ok) ok = check(def.material);
  if (ok) ok = check_finite(def.linear_drag, "linear drag of a body");
  if (ok) ok = check_finite(def.angular_drag, "angular drag of a body");
  if (ok && (def.linear_drag < 0 || def.angular_drag < 0))
    ok = Error{ErrorCode::bad_argument, "A drag is below zero; use 0 for none."};
  for (const ShapeDef& shape : def.shapes) {
    if (ok) ok = check(shape);
    if (ok && shape.kind == ShapeKind::plane && def.kind != BodyKind::fixed)
      ok = Error{ErrorCode::degenerate_shape, "A plane is infinite; use it on fixed bodies only."};
  }
  if (!ok) return ok.error();
  if (def.kind != BodyKind::dynamic) return MassProperties{};
  Result<MassProperties> mass = mass_of(def);
  if (!mass) return mass;
  ok = check(*mass, def.rotates);
  if (ok && !def.rotates && def.angular_velocity != Vec3{}) ok = no_rotation();
  if (!def.rotates) mass->moments = {};
  if (ok) ok = check_spin(mass->moments, def.angular_velocity);
  if (!ok) return ok.error();
  return mass;
}

Status check(AngleFreedom& f) {
  if (f.kind > AngleFreedom::Kind::pitch_yaw_roll)
    return Error{ErrorCode::bad_joint,
                 "A joint's freedom is of no known kind; use AngleFreedom::cone_and_twist, between, hinge or locked."};
  for (double x : {f.cone, f.twist, f.lower.x, f.lower.y, f.lower.z, f.upper.x, f.upper.y, f.upper.z})
    if (std::isnan(x))
      return Error{ErrorCode::bad_joint,
                   "The cone and twist of a joint, or an angle limit, is not a number; give angles [rad], or infinity "
                   "for none."};
  if (f.kind == AngleFreedom::Kind::cone_twist) {
    if (!(f.cone >= 0) || !(f.twist >= 0))
      return Error{ErrorCode::bad_joint, "The cone and twist of a joint must be zero or above [rad]."};
  } else if (f.kind == AngleFreedom::Kind::pitch_yaw_roll) {
    const double lower[3] = {f.lower.x, f.lower.y, f.lower.z}, upper[3] = {f.upper.x, f.upper.y, f.upper.z};
    for (int k = 0; k < 3; k++)
      if (!(lower[k] <= upper[k]))
        return Error{ErrorCode::bad_joint, "An angle limit of a joint has its lower bound above its upper one."};
  }
  if (!(f.restitution >= 0 && f.restitution <= 1))
    return Error{ErrorCode::bad_joint,
                 "The restitution of a joint's limits is " + number(f.restitution) +
                     "; it must lie between 0 (it stops there) and 1 (it leaves as fast as it came)."};
  return {};
}

namespace {
Status check_not_negative(double value, const char* what, const char* unit) {
  if (Status ok = check_finite(value, what); !ok) return ok;
  if (value < 0)
    return Error{ErrorCode::bad_joint, std::string("The ") + what + " is " + number(value) + " " + unit +
                                           "; it must be zero (none) or above."};
  return {};
}
}  // namespace

Status check(const Motor& motor) {
  Status ok = check_finite(motor.speed, "speed of a motor");
  if (ok) ok = check_not_negative(motor.torque, "torque of a motor", "N m");
  return ok;
}

Status check(AngularSpring& spring) {
  Status ok = check_not_negative(spring.stiffness, "stiffness of an angular spring", "N m/rad");
  if (ok) ok = check_not_negative(spring.damping, "damping of an angular spring", "N m s/rad");
  if (ok) ok = check_unit(spring.rest, "rest orientation of an angular spring");
  return ok;
}

Status check(const SpringDef& def) {
  Status ok = check_finite(def.anchor_a, "anchor of a spring in body a");
  if (ok) ok = check_finite(def.anchor_b, "anchor of a spring in body b");
  if (ok) ok = check_not_negative(def.rest_length, "rest length of a spring", "m");
  if (ok) ok = check_not_negative(def.stiffness, "stiffness of a spring", "N/m");
  if (ok) ok = check_not_negative(def.damping, "damping of a spring", "N s/m");
  return ok;
}

}  // namespace pcphys
