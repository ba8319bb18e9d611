// Sub-steps for joints that turn far. Directions of joints are those at the start of a sub-step (docs/joint-trees.md): of second
// order, and of no use where a body turns by a radian.
#pragma once
#include <cstdint>
#include <vector>

#include "plan/wanted.h"
#include "world/state.h"

namespace pcphys {

class Forest;

/// Adds what bodies in trees need that would turn by more than constants::largest_joint_turn in a sub-step of `h` [s], up to
/// `highest_octave`. Bodies on pivots turn exactly.
void want_for_spins(const WorldState& state, const Forest& forest, double h, std::uint8_t highest_octave,
                    std::vector<Wanted>& wanted);

}  // namespace pcphys
