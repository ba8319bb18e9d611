// How well a run went: the measures of the peers' programs, in the same definitions, from the poses that a
// world shows. Nothing here is fast; it runs outside of what is timed.
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

/// One pose for each body of the scene; one that cannot be read is not finite.
std::vector<Pose> poses(const Scene& scene, const World& world);

/// Scenes with supports: vertical overlap of a box with what it was built on. Scenes in the open-lidded box:
/// overlap of every pair of round bodies, or of hulls, that no joint connects, and of each with floor and walls. Others: floor.
Penetration penetration(const Scene& scene, const World& world, std::span<const Pose> poses);
Separation joint_separation(const Scene& scene, const World& world);
/// How far the worst joint is beyond its cone, twist, pitch, yaw or roll limit; 0 within all limits [rad].
double limit_excess(const Scene& scene, const World& world);
/// Which bodies went over the rim of the open-lidded box: others threw them out, no wall let them through.
class RimWatch {
 public:
  /// To be called after each step.
  void look(const Scene& scene, const World& world);
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
long nonfinite(const Scene& scene, const World& world, std::span<const Pose> poses);
Drift drift(const Scene& scene, std::span<const Pose> poses);

struct Metrics {
  Penetration penetration;
  Separation separation;
  double limit_excess = 0;  // [rad]
  Escapes escapes;
  long nonfinite = 0;
  Drift drift;
  double kinetic = 0, potential = 0;  // velocities in phase with positions [J]
  Vec3 momentum, angular_momentum;    // [kg m/s], about the origin [kg m^2/s]

  double energy() const { return kinetic + potential; }
};

Metrics measure(const Scene& scene, const World& world, const RimWatch& rim = {});

}  // namespace pcphys::scenes
