// Which calls walk over a world, and how one that breaks an invariant ends the process.
#include <cstdint>
#include <new>
#include <string>

#include "pcphys/result.h"
#include "world/invariants.h"
#include "world/state.h"

namespace pcphys {

void walk_invariants(WorldState& state, const char* call) {
  const std::string broken = broken_invariant(state);
  if (broken.empty()) return;
  const std::string seen = std::string("seen by ") + call + ", after " + state.seen.last_call;
  detail::misuse(
      ("A fault of the library, which should be reported: a world breaks an invariant, " + seen + ". " + broken + ".")
          .c_str());
}

void walk_when_due(WorldState& state, const char* call) {
  constexpr std::uint64_t rows_a_call = 1024;
  const std::uint64_t rows = state.bodies.size() + state.joints.size() + state.shapes.size() + state.forces.size() +
                             state.contacts.keys.size();
  state.seen.rows_paid += rows_a_call;
  if (state.seen.rows_paid >= rows) {
    state.seen.rows_paid = 0;
    try {
      walk_invariants(state, call);
    } catch (const std::bad_alloc&) {}
  }
  state.seen.last_call = call;
}

}  // namespace pcphys
