// What contacts did in each sub-step, for tests and `pcphys wild`: on the CPU alone, and only while somebody looks.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "world/state.h"

namespace pcphys {

/// A manifold of the sub-step that has just been made, whether it pushed or not. What contact_restitution adds at the
/// end of a step is not among it.
struct TracedContact {
  std::uint32_t contact = 0;         // row of the table of contacts
  std::array<double, 4> impulse{};   // of the rows, along the normal, by point [N s]
  std::array<double, 2> friction{};  // of the rows, along both tangents [N s]
  /// By impacts since the step began, along the normal, by point; below 0: none was [N s].
  std::array<double, 4> struck{};
};

class ContactTrace {
 public:
  virtual ~ContactTrace() = default;
  /// A step begins, or is made again: what was told of it so far does not count. Poses are those before the step. One
  /// in which nothing meets or holds a body has no sub-steps to tell of (StepPlan::flight).
  virtual void begin(const WorldState& state) = 0;
  /// A sub-step of one level of islands is done: poses are those at its end. `h`: its length [s].
  virtual void substep(const WorldState& state, double h, std::span<const TracedContact> contacts) = 0;
};

}  // namespace pcphys
