// Reads from the CPU's scratch what contacts did in a sub-step, while somebody looks.
#pragma once
#include <cstddef>
#include <vector>

#include "plan/plan.h"
#include "step/backend.h"
#include "step/contact_trace.h"
#include "step/schedule.h"

namespace pcphys {

/// What has just run: the last entry of a sub-step of one level of islands.
struct TracedRun {
  const WorldState& state;
  const Schedule& schedule;
  const StepPlan& plan;
  const PlanEntry& entry;
  const Backend& backend;
};

class Tracer {
 public:
  ContactTrace* told = nullptr;

  /// `infos`: all info blocks of the step, in the world's precision; `block`: that of the entry.
  void substep(const TracedRun& run, const void* infos, std::size_t block);

 private:
  template <class Scalar> void substep_of(const TracedRun& run, const void* infos, std::size_t block);

  std::vector<TracedContact> contacts_;
};

/// Whether a plan goes on to another sub-step, or to what follows the last one, between these two entries.
bool ends_substep(const PlanEntry& before, const PlanEntry& next);

}  // namespace pcphys
