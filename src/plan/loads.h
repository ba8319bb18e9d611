// Sub-steps for heavy loads. A contact is as stiff as the lighter of its bodies lets it be (docs/impulses.md), so a load of a
// thousand times that body presses it in by a thousand times as much; sub-steps undo that with their square.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pcphys/step.h"
#include "plan/solved_joints.h"
#include "plan/wanted.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class TreeNodes;

class Loads {
 public:
  /// Follows a change of contacts: finds those in which a free body could carry one much heavier than itself.
  void find(const WorldState& state, const TreeNodes& trees);
  void forget_contacts() { uneven_.clear(); }
  /// Adds what sub-steps of `h`, as soft rows are made for, need, up to `highest_octave`, for the weights that could rest on lighter bodies.
  void want(const WorldState& state, double h, std::uint8_t highest_octave, std::vector<Wanted>& wanted) const;
  std::size_t memory_bytes() const { return bytes_of(uneven_); }

 private:
  struct Uneven {
    std::uint32_t contact, lighter;
    double ratio;  // of the masses; below zero where the normal leads from the heavier body to the lighter
  };
  std::vector<Uneven> uneven_;
};

}  // namespace pcphys
