// Sub-steps for heavy loads. A contact is as stiff as the lighter of its bodies lets it be (docs/impulses.md), so a load of a
// thousand times that body presses it in by a thousand times as much; sub-steps undo that with their square.
#pragma once
#include <cstdint>
#include <vector>

#include "pcphys/step.h"
#include "world/state.h"

namespace pcphys {

class TreeNodes;

class Loads {
 public:
  /// Follows a change of contacts: finds those in which a free body could carry one much heavier than itself.
  void find(const WorldState& state, const TreeNodes& trees);
  /// By what the sub-steps of a step of `dt` are to be multiplied, from the weights that could rest on lighter bodies: a power
  /// of two.
  std::uint32_t refinement(const WorldState& state, const StepSettings& settings, double dt) const;

 private:
  struct Uneven {
    std::uint32_t contact;
    double ratio;  // of the masses; below zero where the normal leads from the heavier body to the lighter
  };
  std::vector<Uneven> uneven_;
};

}  // namespace pcphys
