// Reads from the CPU's scratch what contacts did in a sub-step, while somebody looks.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "plan/plan.h"
#include "step/backend.h"
#include "step/contact_trace.h"
#include "step/schedule.h"

namespace pcphys {

/// Where the rows of a sub-step's contacts stand.
struct TracedRows {
  std::uint32_t width = 1;  // slots side by side
  bool friction = true;     // rows are those with friction
  bool f64 = false;
};

class Tracer {
 public:
  ContactTrace* told = nullptr;

  /// Of islands of one level (`octave`, a plan entry's); `h`: the length of the sub-step [s].
  void substep(const WorldState& state, const Schedule& schedule, unsigned octave, const Backend& backend,
               const TracedRows& rows, double h);

 private:
  template <class Scalar>
  void collect(const Schedule& schedule, unsigned octave, const Backend& backend, const TracedRows& rows);

  std::vector<TracedContact> contacts_;
};

/// Whether a plan goes on to another sub-step, or to what follows the last one, between these two entries.
bool ends_substep(const PlanEntry& before, const PlanEntry& next);

}  // namespace pcphys
