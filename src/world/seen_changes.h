// Whether what a world counts is counted: what stands there is compared with what stood there when
// somebody last looked.
#pragma once
#include <cstdint>

namespace pcphys {

struct WorldState;

/// The counters, and sums over what they count, as a walk over the invariants saw them last.
struct SeenChanges {
  struct Counter {
    std::uint64_t count = 0, sum = 0;
  };
  bool walked = false;  // before
  Counter structure, contacts, rest;
  std::uint64_t joint_changes = 0, removals = 0;
  std::uint64_t rows_paid = 0;           // of the next walk, by calls since the last (walk_when_due)
  const char* last_call = "its making";  // that may have changed the world
};

/// Why a change since then was not counted, or null; from now on they are those of now. Its counts of bodies are right.
const char* find_uncounted(WorldState& state);

}  // namespace pcphys
