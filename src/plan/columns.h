// Sub-steps for what stands high on bodies that are small for the sub-step. A contact gives by the load over its lighter body's mass, times
// the square of the sub-step (docs/impulses.md): where that is no longer small beside the bodies, piles lean and fall. How many bodies
// of its own kind a body may carry is taken from how high its island is, so that it is known before the load is there.
#pragma once
#include <cstdint>
#include <vector>

#include "plan/wanted.h"
#include "world/state.h"

namespace pcphys {

class Islands;
class TreeNodes;

class Columns {
 public:
  /// Follows a change of contacts. `faces`: some contact has more than one point, so that something may stand on something.
  void find(const WorldState& state, const TreeNodes& trees, bool faces);
  /// Adds what sub-steps of `h` need, up to `highest_octave`.
  void want(const WorldState& state, const TreeNodes& trees, double h, std::uint8_t highest_octave, Islands& islands,
            std::vector<Wanted>& wanted);

 private:
  struct Column {
    std::uint32_t bodies = 0;
    double low = 0, high = 0;  // along gravity, upward [m]
    double sizes = 0;          // sum over its bodies [m]
  };
  void measure(const WorldState& state, const TreeNodes& trees, Islands& islands);

  std::vector<Column> columns_;               // by the root of an island; empty: not measured since contacts changed
  double smallest_ = 0, low_ = 0, high_ = 0;  // of all that could stand; smallest_ 0: there is nothing [m]
};

}  // namespace pcphys
