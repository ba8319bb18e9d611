// The numbers that kernels are given besides buffers, from dt and the settings.
#pragma once
#include "pcphys/math.h"
#include "pcphys/plan.h"
#include "pcphys/step.h"
#include "world/schema.h"

namespace pcphys {

/// [s]
double substep_length(const StepSettings& settings, double dt);
/// What time the impulses stand for that joints remember of the step's last sub-step [s]: the sub-step; but the first one
/// after a change takes up forces for half of the sub-step before and half of its own (kernels/begin.inl).
double load_time(const StepSettings& settings, double dt, double last_substep);

/// One block a phase, by Phase. `last_substep`: of the step before, 0 if there was none [s]; `load_time`: see load_time().
template <class Scalar>
void fill_infos(const StepSettings& settings, Vec3 gravity, double dt, double last_substep, double load_time,
                InfoOf<Scalar> (&infos)[phase_count]);

}  // namespace pcphys
