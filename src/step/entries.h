// What a plan's entries are to the runner.
#pragma once
#include <cstddef>

#include "pcphys/step.h"
#include "plan/plan.h"

namespace pcphys {

inline Timer timer_of(Stage stage) {
  constexpr Timer timers[] = {Timer::integrate, Timer::joints, Timer::impulses, Timer::plan};
  return timers[std::size_t(stage)];
}
inline Timer timer_of(const PlanEntry& entry) {
  if (entry.kind == PlanEntry::Kind::collide) return Timer::narrow;
  if (entry.kind == PlanEntry::Kind::upload) return Timer::upload;
  if (entry.kind == PlanEntry::Kind::download) return Timer::download;
  return timer_of(stage(entry));
}

/// The numbers of a class are those of its octave, whatever the order.
inline std::size_t info_index(const PlanEntry& entry) {
  return std::size_t{octave_of(entry.octave)} * phase_count + std::size_t(entry.phase);
}

inline bool prepares(Kernel k) { return k == Kernel::contact_prepare || k == Kernel::contact_prepare_frictionless; }
inline bool strikes(Kernel k) { return k == Kernel::contact_impact || k == Kernel::contact_impact_frictionless; }

}  // namespace pcphys
