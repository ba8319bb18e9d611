// One contact handed straight to the solver: impacts at the exact touching configuration.
#pragma once
#include "pcphys/plan.h"
#include "pcphys/result.h"
#include "pcphys/types.h"

namespace pcphys::cases {

/// Two spheres that touch, or a sphere and a box, and what the impulse stage makes of their velocities.
struct SphereContact {
  double mass1 = 1, mass2 = 1, radius1 = 0.1, radius2 = 0.2;
  Vec3 normal{1, 0, 0};  // unit, from 1 to 2
  Vec3 v1, v2, w1, w2;   // before and after
  double friction = 0, restitution = 0;
  Vec3 half2;  // of a box with axes x, y, z in place of the second sphere; zero: that sphere
  Vec3 at2;    // where the box is met, from its centre
};

/// The step of `resolve`: so short that nothing moves [s].
double direct_step(Precision precision);

/// Runs the kernels of one step, as the plan orders them, on exactly this configuration: the narrow phase
/// cannot give it, since the digits of a gap end where those of the positions do.
Status resolve(SphereContact& contact, Precision precision, Place place, std::uint32_t lanes = 0);

}  // namespace pcphys::cases
