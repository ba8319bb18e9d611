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
void find_leaving(const WorldState& state, std::span<const std::uint32_t> bodies, double dt,
                  std::vector<std::uint32_t>& leaving);

/// The first row in [begin, end) that holds a number which is not finite, of a type of that buffer's `offset` bytes
/// into the row; `end` if there is none.
std::uint32_t find_not_finite(const Tables& tables, Buffer buffer, std::uint32_t offset, PropertyType type,
                              std::uint32_t begin, std::uint32_t end);

}  // namespace pcphys
