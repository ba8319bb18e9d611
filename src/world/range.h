// Which bodies leave the range of numbers that a step can go on with (constants::largest_state).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "world/state.h"

namespace pcphys {

/// Of `bodies` those whose numbers are out of range.
void find_outside(const WorldState& state, std::span<const std::uint32_t> bodies, std::vector<std::uint32_t>& outside);
/// Those that would be after `dt` under gravity and their own forces alone.
void find_leaving(const WorldState& state, std::span<const std::uint32_t> bodies, double dt, std::vector<std::uint32_t>& leaving);

}  // namespace pcphys
