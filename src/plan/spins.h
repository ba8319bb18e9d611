// Sub-steps for joints that turn far, and for chains that whip. Directions of joints are those at the start of a
// sub-step (docs/joint-trees.md): of second order, and of no use where a body turns by a radian. How much a sub-step
// changed a spin, times its length, is how wrong they came to be in it (docs/substeps.md).
#pragma once
#include <cstdint>
#include <vector>

#include "plan/wanted.h"
#include "world/state.h"

namespace pcphys {

class Forest;
class Islands;

/// Adds what bodies in trees need that would turn by more than constants::largest_joint_turn in a sub-step of `h` [s],
/// up to `highest_octave`; in trees with limits that nothing touches, and that are an island of their own, by the root
/// of constants::largest_give. And what trees that nothing touches need of which a body's spin changed by
/// more than constants::largest_give / h in the last sub-step. Bodies on pivots turn exactly.
void want_for_spins(const WorldState& state, const Forest& forest, Islands& islands, double h,
                    std::uint8_t highest_octave, std::vector<Wanted>& wanted);

}  // namespace pcphys
