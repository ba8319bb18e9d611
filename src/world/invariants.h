// What holds of a world between two calls: a walk over all of it, which names the first thing that does not.
#pragma once
#include <string>

namespace pcphys {

struct WorldState;

/// The first invariant that is broken, as a sentence; "" where all hold. Rows that a device holds alone are not looked
/// at: the walk fetches nothing. Needs memory for marks alone.
std::string broken_invariant(WorldState& state);

/// Ends the process with that sentence; `call`: who looks.
void walk_invariants(WorldState& state, const char* call);

/// The same where calls so far have paid for it. A walk visits each row, and every call pays for so many rows: small
/// worlds are walked in each call, large ones so rarely that a call costs the same in all of them. Without memory for
/// marks there is no walk.
void walk_when_due(WorldState& state, const char* call);

/// In debug builds, where a call begins that changes the world, for what the one before left;
/// where a step and a world end.
inline void walk_in_debug([[maybe_unused]] WorldState& state, [[maybe_unused]] const char* call) {
#ifndef NDEBUG
  walk_when_due(state, call);
#endif
}

}  // namespace pcphys
