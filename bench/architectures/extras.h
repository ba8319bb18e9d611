// What was added to every design when it stood: a property (the area that a body shows the wind), a force (the wind's),
// a constraint (ropes). The physics stands here once; what each design needs for it stands
// in its file between the marks
//   // [property], // [force], // [constraint] ... // [end]
// and tools/architectures_report.py counts those lines. A mark behind a line counts that line alone.
#pragma once
#include "pcphys/kernel.h"

namespace pcphys::architectures {

/// Force of the wind on a body: along the relative speed, with its square.
void wind_drag(const float velocity[3], float area, float force[3], const float wind[3]);
/// The same text as Stepper::add_kernel takes it.
KernelText wind_kernel();

/// Two bodies' centres come no further apart than `length`; their velocities change along the line between them, in
/// inverse proportion to the masses.
void hold_rope(const float* pose_a, const float* pose_b, float length, float* motion_a, float* motion_b,
               float inverse_h);

}  // namespace pcphys::architectures
