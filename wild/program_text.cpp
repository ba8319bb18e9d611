#include "wild/program_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace pcphys::wild::program {

std::string text(double value) {
  if (std::isnan(value)) return "std::nan(\"\")";
  if (std::isinf(value)) return value > 0 ? "infinity" : "-infinity";
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  std::string digits(buffer, end);
  // What would be read as an integer keeps neither the sign of a zero nor more than nine digits.
  const bool whole = digits.find_first_of(".e") == std::string::npos;
  if (whole && (digits == "-0" || digits.size() > 9)) digits += ".0";
  return digits;
}
std::string text(bool value) { return value ? "true" : "false"; }
std::string text(std::int32_t value) { return std::to_string(value); }
std::string text(std::uint32_t value) { return std::to_string(value) + (value > 0x7fffffffu ? "u" : ""); }
std::string text(std::size_t value) { return std::to_string(value); }
std::string text(Vec3 v) { return v == Vec3{} ? "{}" : "{" + text(v.x) + ", " + text(v.y) + ", " + text(v.z) + "}"; }
std::string text(Quat q) {
  if (q == Quat{}) return "{}";
  return "{" + text(q.x) + ", " + text(q.y) + ", " + text(q.z) + ", " + text(q.w) + "}";
}
std::string text(const Pose& pose) {
  if (pose == Pose{}) return "{}";
  return "{" + text(pose.position) + ", " + text(pose.orientation) + "}";
}

std::string text(Precision precision) { return precision == Precision::f64 ? "Precision::f64" : "Precision::f32"; }
std::string text(Place place) { return place == Place::gl ? "Place::gl" : "Place::cpu"; }
std::string text(Integrator integrator) {
  return integrator == Integrator::seed ? "Integrator::seed" : "Integrator::verlet";
}
std::string text(NarrowPhase narrow) { return narrow == NarrowPhase::fcl ? "NarrowPhase::fcl" : "NarrowPhase::native"; }
std::string text(BodyKind kind) {
  constexpr std::array names{"fixed", "kinematic", "dynamic"};
  return std::string("BodyKind::") + names[std::size_t(kind)];
}
std::string text(ShapeKind kind) {
  constexpr std::array names{"sphere", "capsule", "box", "cylinder", "hull", "plane"};
  return std::string("ShapeKind::") + names[std::size_t(kind)];
}
std::string text(Combine rule) {
  constexpr std::array names{"mean", "geometric_mean", "minimum", "product", "maximum"};
  return std::string("Combine::") + names[std::size_t(rule)];
}
std::string text(AngleFreedom::Kind kind) {
  constexpr std::array names{"free", "cone_twist", "pitch_yaw_roll"};
  return std::string("AngleFreedom::Kind::") + names[std::size_t(kind)];
}

Members members(const Material& m) {
  const Material usual;
  Members list("Material");
  list.add("static_friction", m.static_friction, usual.static_friction);
  list.add("kinetic_friction", m.kinetic_friction, usual.kinetic_friction);
  list.add("restitution", m.restitution, usual.restitution);
  list.add("rolling_friction", m.rolling_friction, usual.rolling_friction);
  list.add("torsional_friction", m.torsional_friction, usual.torsional_friction);
  list.add("friction_rule", m.friction_rule, usual.friction_rule);
  list.add("restitution_rule", m.restitution_rule, usual.restitution_rule);
  return list;
}

Members members(const Filter& f) {
  const Filter usual;
  Members list("Filter");
  list.add("category", f.category, usual.category);
  list.add("mask", f.mask, usual.mask);
  list.add("group", f.group, usual.group);
  return list;
}

Members members(const AngleFreedom& f) {
  const AngleFreedom usual;
  Members list("AngleFreedom");
  list.add("kind", f.kind, usual.kind).add("cone", f.cone, usual.cone).add("twist", f.twist, usual.twist);
  list.add("lower", f.lower, usual.lower).add("upper", f.upper, usual.upper);
  list.add("restitution", f.restitution, usual.restitution);
  return list;
}

Members members(const Motor& m) { return Members("Motor").add("speed", m.speed, 0.0).add("torque", m.torque, 0.0); }

Members members(const AngularSpring& s) {
  Members list("AngularSpring");
  return list.add("stiffness", s.stiffness, 0.0).add("damping", s.damping, 0.0).add("rest", s.rest, Quat{});
}

Members members(const StepSettings& s) {
  const StepSettings usual;
  Members list("StepSettings");
  list.add("integrate", s.integrate, usual.integrate).add("joints", s.joints, usual.joints);
  list.add("impulses", s.impulses, usual.impulses).add("integrator", s.integrator, usual.integrator);
  list.add("substeps", s.substeps, usual.substeps).add("order", s.order, usual.order);
  list.add("refinement", s.refinement, usual.refinement).add("lanes", s.lanes, usual.lanes);
  list.add("threads", s.threads, usual.threads).add("narrow", s.narrow, usual.narrow);
  list.add("sleep", s.sleep, usual.sleep).add("islands", s.islands, usual.islands);
  list.add("sleep_speed", s.sleep_speed, usual.sleep_speed).add("sleep_spin", s.sleep_spin, usual.sleep_spin);
  list.add("sleep_time", s.sleep_time, usual.sleep_time).add("push_speed", s.push_speed, usual.push_speed);
  list.add("restitution_threshold", s.restitution_threshold, usual.restitution_threshold);
  list.add("contact_margin", s.contact_margin, usual.contact_margin).add("max_pairs", s.max_pairs, usual.max_pairs);
  return list;
}

}  // namespace pcphys::wild::program
