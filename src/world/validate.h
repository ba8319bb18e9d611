// Checks of everything a host hands in. Each error says what was wrong and what to do.
#pragma once
#include <string>

#include "pcphys/result.h"
#include "pcphys/types.h"

namespace pcphys {

/// As error messages show it: six digits at most.
std::string number(double x);
/// Of an id that names nothing; `what` is "body", "joint", "force".
Error stale(const char* what);
/// There is no memory for what was asked, and all is as it was. (Made without any.)
Error no_memory();
/// The same of the exception that is being handled. Any other than for want of memory is a fault of ours, and ends the
/// process with its sentence.
Error caught();
/// `what` is "world" or "stepper".
Error busy(const char* what);
/// Of an angular velocity for a body of BodyDef::rotates = false.
Error no_rotation();
/// Of a body of that kind: a fixed one has none but zero. `what` is "velocity", "angular velocity".
Status check_moves(BodyKind kind, Vec3 value, const char* what);
Status check_finite(double value, const char* what);
Status check_finite(Vec3 value, const char* what);
/// Whether a body of such moments may spin so fast, however it is turned.
Status check_spin(Vec3 moments, Vec3 angular_velocity);
/// Finite and of unit length within the tolerance; then normalised in place.
Status check_unit(Quat& value, const char* what);
Status check(const ShapeDef& shape);
Status check(const Material& material);
/// `rotates`: BodyDef::rotates; the moments of others are not looked at.
Status check(const MassProperties& mass, bool rotates = true);
Status check(AngleFreedom& freedom);
/// Everything of a body; `orientation` is then the normalised one. Answers its mass, nothing unless it is dynamic.
Result<MassProperties> check(const BodyDef& def, Quat& orientation);
/// Frames, which are then normalised, and freedom of a joint; not its bodies.
Status check(JointDef& def);
/// Torque of a motor; stiffness, damping and orientation of a spring, which is then normalised.
Status check(const Motor& motor);
Status check(AngularSpring& spring);
Status check(const SpringDef& def);

}  // namespace pcphys
