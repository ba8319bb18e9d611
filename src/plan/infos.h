// The numbers that kernels are given besides buffers, from dt and the settings.
#pragma once
#include "pcphys/math.h"
#include "pcphys/plan.h"
#include "pcphys/step.h"
#include "world/schema.h"

namespace pcphys {

/// [s]
inline double substep_length(double dt, std::uint32_t substeps) { return dt / substeps; }

/// The sub-step that soft rows are made for [s]. Their stiffness goes by its inverse square, so a pile would be as much
/// thicker in a shorter step, and steps in turns would shake it: stiffness falls at once where sub-steps get longer,
/// and rises again in constants::stiffening_time. `before`: that of the step before, 0 if there was none.
double soft_substep_length(double before, double h, double dt);

/// All that they follow from.
struct InfoInputs {
  InfoInputs() = default;
  /// `h`: the world's sub-step, of octave 0; `last_substep`: of the step before, 0 if there was none; `soft_substep`:
  /// that soft rows are made for, at least h [s].
  InfoInputs(const StepSettings& settings, Vec3 gravity, double h, double last_substep, double soft_substep,
             bool carries = false)
      : gravity(gravity),
        h(h),
        soft_substep(soft_substep),
        last_substep(last_substep),
        push_speed(settings.push_speed),
        restitution_threshold(settings.restitution_threshold),
        substeps(settings.substeps),
        carries(carries) {}

  Vec3 gravity;
  double h = 0, soft_substep = 0, last_substep = 0, push_speed = 0, restitution_threshold = 0;
  std::uint32_t substeps = 1;
  bool carries = false;  // some body is kinematic
  friend bool operator==(const InfoInputs&, const InfoInputs&) = default;
};

/// One block a phase, by Phase, for islands of an octave.
/// What is remembered from step to step is of the world's sub-step.
template <class Scalar>
void fill_infos(const InfoInputs& from, InfoOf<Scalar> (&infos)[phase_count], unsigned octave = 0);

}  // namespace pcphys
