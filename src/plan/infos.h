// The numbers that kernels are given besides buffers, from dt and the settings.
#pragma once
#include "pcphys/math.h"
#include "pcphys/plan.h"
#include "pcphys/step.h"
#include "world/schema.h"

namespace pcphys {

/// [s]
double substep_length(double dt, std::uint32_t substeps);

/// One block a phase, by Phase. `h`: the world's sub-step, of octave 0; `last_substep`: of the step before, 0 if there was
/// none [s]. What is remembered from step to step is of the world's sub-step.
template <class Scalar>
void fill_infos(const StepSettings& settings, Vec3 gravity, double h, double last_substep, InfoOf<Scalar> (&infos)[phase_count],
                unsigned octave = 0);

}  // namespace pcphys
