// What the tests of joint trees share: rods and joints at places of the world, and what to watch in a run.
#pragma once
#include <algorithm>
#include <numbers>
#include <string>

#include "support_physics.h"

namespace trees {
using namespace physics;

inline constexpr double frame = 1.0 / 60, degree = std::numbers::pi / 180;
inline constexpr double millimetre = 1e-3;

/// The worst of a run.
struct Worst {
  double separation = 0;  // of any joint [m]
  double gain = 0;        // of energy above that of the start [J]
  double lost = 0;        // of it at the end [J]
  double kinetic = 0;     // the largest [J]
  bool finite = true;
};

inline double energy(const World& world) { return world.kinetic_energy() + world.potential_energy(); }

inline void note(Worst& worst, const World& world, double start) {
  for (const JointId joint : world.joints())
    worst.separation = std::max(worst.separation, *world.joint_separation(joint));
  worst.kinetic = std::max(worst.kinetic, world.kinetic_energy());
  worst.lost = start - energy(world);
  worst.gain = std::max(worst.gain, -worst.lost);
  for (const BodyId body : world.bodies()) worst.finite &= std::isfinite(length(world.pose(body)->position));
  worst.finite &= std::isfinite(energy(world));
}

inline Worst watch(Run& run, long steps = 300) {
  const double start = energy(run.world);
  Worst worst;
  for (long i = 0; i < steps; i++) {
    run.step(frame);
    note(worst, run.world, start);
  }
  return worst;
}

inline void tell(const std::string& what, const Mode& mode, const Worst& w, double range) {
  MESSAGE("trees, " << what << ", " << mode.name() << ": separation " << w.separation / millimetre
                    << " mm, energy gained " << w.gain / range << " and at the end lost " << w.lost / range
                    << " of its range");
}

/// A body that touches nothing.
inline BodyDef rod(Vec3 half_extents, double mass, Vec3 position, Quat orientation = {}) {
  BodyDef def;
  def.shapes = {ShapeDef::box(half_extents)};
  def.shapes[0].filter.mask = 0;
  def.mass = mass;
  def.pose = {position, orientation};
  return def;
}

/// A joint at a place of the world, whose axes are `axes` there.
inline JointId join(Run& run, BodyId a, BodyId b, Vec3 place, const AngleFreedom& freedom = {}, Quat axes = {}) {
  JointDef def;
  def.a = a;
  def.b = b;
  const auto local = [&](BodyId body) {
    const Pose pose = body == run.world.ground() ? Pose{} : *run.world.pose(body);
    const Quat back = conjugate(pose.orientation);
    return Pose{rotate(back, place - pose.position), back * axes};
  };
  def.frame_a = local(a);
  def.frame_b = local(b);
  def.freedom = freedom;
  const auto made = run.world.create_joint(def);
  if (!made) FAIL(made.error().message);
  return *made;
}

inline const Quat about_z = axis_angle({0, 1, 0}, -0.5 * std::numbers::pi);  // turns the x axis, a hinge's, to z

}  // namespace trees
