// Bodies that one pin alone holds to a fixed body: they turn about the pin (src/kernels/pivot_turn.inl).
#pragma once
#include <span>
#include <vector>

#include "plan/forest.h"
#include "plan/solved_joints.h"
#include "world/state.h"

namespace pcphys {

/// One tree of a fixed root and one body, which no other joint holds.
struct Pivot {
  std::size_t tree;
  std::uint32_t body, joint;  // rows
  bool flipped;               // the joint's body a is the one that turns
  bool limited;               // its angles have limits
};

std::vector<Pivot> find_pivots(const Forest& forest, const WorldState& state, const SolvedJoints& joints);
/// What kernels know of them: the buffer joint_pivot.
void write_pivots(WorldState& state, const SolvedJoints& joints, std::span<const Pivot> pivots);

}  // namespace pcphys
