// Sub-steps for heavy loads. A contact is as stiff as the lighter of its bodies lets it be (docs/impulses.md), so a load of a
// thousand times that body presses it in by a thousand times as much; sub-steps undo that with their square. A joint that closes a loop
// under tension needs sub-steps that resolve how fast its bodies swing in it (docs/joint-trees.md).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pcphys/step.h"
#include "plan/solved_joints.h"
#include "plan/wanted.h"
#include "world/state.h"

namespace pcphys {

class TreeNodes;

class Loads {
 public:
  /// Follows a change of contacts: finds those in which a free body could carry one much heavier than itself.
  void find(const WorldState& state, const TreeNodes& trees);
  void forget_contacts() { uneven_.clear(); }
  /// Follows a change of objects. `closing`: rows of the joints that close loops and that trees answer.
  void find_loops(const WorldState& state, const SolvedJoints& joints, std::span<const std::uint32_t> closing);
  /// Adds what a step of `dt` needs, up to `highest_octave`, for the weights that could rest on lighter bodies, and for
  /// the tension of loops in the last step.
  void want(const WorldState& state, const StepSettings& settings, double dt, std::uint8_t highest_octave,
            std::vector<Wanted>& wanted) const;

 private:
  struct Uneven {
    std::uint32_t contact, body;
    double ratio;  // of the masses; below zero where the normal leads from the heavier body to the lighter
  };
  struct Loop {
    std::uint32_t joint, body;
    double ratio;  // of the square of the frequency at which its lighter body swings, and the force [1/(kg m)]
  };
  std::vector<Uneven> uneven_;
  std::vector<Loop> loops_;
};

}  // namespace pcphys
