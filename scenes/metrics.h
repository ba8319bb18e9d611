// How well a run went: the measures of the peers' programs, in the same definitions. They are taken from poses and
// velocities, whichever engine these came from. Nothing here is fast; it runs outside of what is timed.
#pragma once
#include <span>
#include <vector>

#include "scene.h"

namespace pcphys::scenes {

/// Overlaps of bodies with each other and with the floor and walls; a mean is over what overlaps.
struct Penetration {
  double max = 0, sum = 0;
  long count = 0;

  void add(double depth);
  double mean() const { return count ? sum / double(count) : 0; }
};

struct Separation {
  double max = 0, mean = 0;  // [m]
};

/// How a pile of boxes moved from where it was built.
struct Drift {
  double sideways = 0, down = 0;  // largest [m]
  int fallen = 0;                 // boxes that lie more than half a metre lower
};

/// Where the bodies of a scene are and how they move, one each in the scene's order.
struct State {
  std::vector<Pose> poses;
  std::vector<Vec3> velocities, angular_velocities;  // of the centre of mass, world axes
};

/// What a world shows; a pose or velocity that cannot be read is not finite.
std::vector<Pose> poses(const Scene& scene, const World& world);
State state(const Scene& scene, const World& world);

/// Scenes with supports: vertical overlap of a box with what it was built on. Scenes in the open-lidded box:
/// overlap of every pair of round bodies, or of hulls, that no joint connects,
/// and of each with floor and walls. Others: floor.
Penetration penetration(const Scene& scene, const World& world, std::span<const Pose> poses);

/// In what follows `world` says how the scene's joints and masses are; where the bodies are is in the poses.
Separation joint_separation(const Scene& scene, const World& world, std::span<const Pose> poses);
/// How far the worst joint is beyond its limits; 0 within all of them [rad].
struct LimitExcess {
  double any = 0;   // cone, twist, pitch, yaw or roll
  double cone = 0;  // cones alone
};
LimitExcess limit_excess(const Scene& scene, const World& world, std::span<const Pose> poses);
/// Of one joint, of bodies that are turned so.
LimitExcess limit_excess(const JointDef& joint, Quat a, Quat b);
/// Which bodies went over the rim of the open-lidded box: others threw them out, no wall let them through.
class RimWatch {
 public:
  /// To be called after each step.
  void look(const Scene& scene, std::span<const Pose> poses);
  bool went_over(std::size_t body) const { return body < above_.size() && above_[body]; }

 private:
  std::vector<bool> above_;  // the rim, when last seen, or since it was last seen below it within the walls
};

/// Bodies that are outside of the open-lidded box's walls or below its floor; in a scene without the box, below its
/// floor by more than 1 m or further than 1 km from where they started.
struct Escapes {
  long through = 0, over_the_rim = 0;
};
Escapes escapes(const Scene& scene, std::span<const Pose> poses, const RimWatch& rim = {});
/// Bodies whose pose or velocity holds NaN or infinity.
long nonfinite(const State& state);
Drift drift(const Scene& scene, std::span<const Pose> poses);

/// Of a rigid body, velocity of its centre, spin in world axes [J];
/// and its angular momentum about the centre [kg m^2/s].
double kinetic_energy(const MassProperties& mass, Quat orientation, Vec3 velocity, Vec3 spin);
Vec3 spin_momentum(const MassProperties& mass, Quat orientation, Vec3 spin);

struct Metrics {
  Penetration penetration;
  Separation separation;
  LimitExcess limit_excess;
  Escapes escapes;
  long nonfinite = 0;
  Drift drift;
  double kinetic = 0, potential = 0;  // of the velocities as they are given; gravity's is zero at the origin [J]
  Vec3 momentum, angular_momentum;    // [kg m/s], about the origin [kg m^2/s]

  double energy() const { return kinetic + potential; }
};

Metrics measure(const Scene& scene, const World& world, const State& state, const RimWatch& rim = {});
/// Of the world's own state: energy with velocities in phase with positions, momenta of those that are stored, which
/// impulses leave unchanged to rounding.
Metrics measure(const Scene& scene, const World& world, const RimWatch& rim = {});

}  // namespace pcphys::scenes
