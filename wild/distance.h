// How far two convex shapes are apart: the judge's own, in double, which knows nothing of the library's collision code.
#pragma once
#include "pcphys/types.h"

namespace pcphys::wild {

/// A shape where it stands. A plane is the half space below its local y = 0.
struct Placed {
  const ShapeDef* shape = nullptr;
  Pose pose;  // of the shape, world axes
};

/// The shape of a body at this pose.
inline Placed placed(const ShapeDef& shape, const Pose& body) {
  return {&shape, {transform(body, shape.local.position), body.orientation * shape.local.orientation}};
}

/// A lower bound of the distance between them that is no less than it by more than 1e-9 of their sizes; 0 where they
/// overlap [m]. By E. Gilbert, D. Johnson, S. Keerthi, A fast procedure for computing the distance between complex
/// objects, 1988.
double distance(const Placed& a, const Placed& b);

/// How they move over a while: velocities [m/s] of the bodies' centres and about them [rad/s], from where they stand
/// now.
struct Moving {
  const ShapeDef* shape = nullptr;
  Pose body;
  Vec3 velocity, angular_velocity;
};

/// The least distance on their way of `seconds`; less than `near` is not told apart from it [m]. Conservative
/// advancement: B. Mirtich, Impulse-based dynamic simulation, 1996.
double least_distance(const Moving& a, const Moving& b, double seconds, double near);

}  // namespace pcphys::wild
