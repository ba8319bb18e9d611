// Bodies that are not at rest, however slow they are, since what kernels of the host's own make forces of changes from
// step to step (docs/sleeping.md).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "step/runner.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class Unrest {
 public:
  /// Before a step: whether all that sleep are to wake.
  bool wakes_all(const WorldState& state, OwnKernels::Ordered kernels);
  /// Whether a kernel of pairs moves bodies: they sleep together or not at all.
  bool together(OwnKernels::Ordered kernels);
  /// After a step: of whom it changed a property of the host's own that goes on from what it was and that forces or
  /// velocities follow from: of bodies themselves, of joints their bodies, of a table of one row all bodies. (What some
  /// kernel writes anew is as old as what that one reads.)
  void find(const WorldState& state, OwnKernels::Ordered kernels, const Runner& runner);
  /// By body row; empty: all are at rest.
  std::span<const char> rows() const { return rows_; }
  /// Those of them that sleep are to wake.
  void stir_sleepers(WorldState& state) const;
  std::size_t memory_bytes() const { return bytes_of(behind_, rows_); }

 private:
  /// Whether the host has given a kernel another parameter since the last step: nobody is at rest.
  static bool of_parameters(OwnKernels::Ordered kernels);
  void find_behind(OwnKernels::Ordered kernels);
  bool moves(const OwnKernel& kernel) const;
  void mark(const WorldState& state, const OwnArgument& argument, const Runner& runner);
  std::vector<Buffer> behind_;  // properties of the host's own that forces or velocities follow from
  std::vector<char> rows_;
};

}  // namespace pcphys
