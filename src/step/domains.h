// What domains and lists of kernels are in a schedule.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "step/backend.h"
#include "step/schedule.h"
#include "world/state.h"

namespace pcphys {

/// The list or slot array behind a buffer that is no table's, or null.
std::vector<std::uint32_t>* list_of(Buffer buffer, Schedule& schedule);
/// Which state of it; of a table that of its rows. Never 0.
std::uint64_t version_of(Buffer buffer, const WorldState& state, const Schedule& schedule);

/// Slots whose kernel writes no body are independent of each other: no colours, no barriers between them.
bool needs_colours(Kernel kernel);
/// How many of a domain may stand side by side.
std::uint32_t side_by_side(Domain domain, const Schedule& schedule);
void pack(Domain domain, std::uint32_t lanes, Schedule& schedule);
std::span<const Range> ranges_of(Domain domain, const Schedule& schedule, unsigned octave);
/// How many slots a buffer of rows has.
std::size_t slots_of(Buffer buffer, Domain domain, const Schedule& schedule);

}  // namespace pcphys
