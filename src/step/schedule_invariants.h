// What holds of a schedule that is of a world's objects of now: who moves goes once,
// and each joint stands in one place.
#pragma once
#include <string>

#include "step/schedule.h"

namespace pcphys {

/// The first invariant that is broken, as a sentence; "" where all hold.
std::string broken_invariant(const WorldState& state, const Schedule& schedule);

/// Ends the process with that sentence. Without memory for marks nothing is looked at.
void walk_invariants(const WorldState& state, const Schedule& schedule);

}  // namespace pcphys
