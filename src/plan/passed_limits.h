// Sub-steps for limits that a step passes: what the axes of a sub-step leave of them falls with its square.
#pragma once
#include <cstdint>
#include <vector>

#include "plan/wanted.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class Forest;

/// After a step, `poses` being those before it: adds by how many octaves, up to `highest`, the islands would have to be
/// higher in which a joint of a tree came to be beyond its limits by more than constants::largest_give [rad]. What was
/// beyond them before is not the step's.
void want_for_passed_limits(const WorldState& state, const Forest& forest, const AlignedBytes& poses,
                            std::uint8_t highest, std::vector<Wanted>& wanted);

}  // namespace pcphys
