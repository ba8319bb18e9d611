// Sub-steps for what stands high on bodies that are small for the sub-step. A contact gives by the load over its
// lighter body's mass, times the square of the sub-step (docs/impulses.md): where that is no longer small beside the
// bodies, piles sink, lean and fall, slender ones sooner. How many bodies of its own kind a body may carry is taken
// from how high its island is, so that it is known before the load is there.
#pragma once
#include <cstdint>
#include <vector>

#include "plan/wanted.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class Islands;
class TreeNodes;

class Columns {
 public:
  /// Follows a change of contacts.
  void forget() { listed_ = false; }
  /// Adds what sub-steps of `h` need, up to `highest_octave`: a function of the present state,
  /// whatever was measured before.
  void want(const WorldState& state, const TreeNodes& trees, double h, std::uint8_t highest_octave, Islands& islands,
            std::vector<Wanted>& wanted);
  std::size_t memory_bytes() const { return bytes_of(bodies_, columns_, column_of_); }

 private:
  struct Body {
    std::uint32_t row, column;
    double size;  // in any direction [m]; 0: it depends on how the body lies
  };
  struct Column {
    std::uint32_t root;  // of its island
    std::uint32_t bodies = 0;
    double sizes = 0;            // sum over its bodies of their size along gravity [m]
    bool faces = false;          // some contact of it has several points, so that something may stand on something
    double low[3]{}, high[3]{};  // along three axes, the first of which leads up [m]
    double extent(int axis) const { return high[axis] - low[axis]; }
  };
  void list(const WorldState& state, const TreeNodes& trees, Islands& islands);

  bool listed_ = false;       // since contacts changed
  std::vector<Body> bodies_;  // that could stand on each other
  std::vector<Column> columns_;
  std::vector<std::uint32_t> column_of_;  // by the root of an island
};

}  // namespace pcphys
