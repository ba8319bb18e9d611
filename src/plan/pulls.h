// Sub-steps for ragdolls that are pulled hard. A limit of a joint yields by a share in each sub-step
// (docs/joint-trees.md), and by all that a pull moves its body in one: a hand of half a kilogram that 10,000 N pull
// moves by 0.3 m in 1/240 s.
#pragma once
#include <cstdint>
#include <vector>

#include "plan/wanted.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class Forest;

class Pulls {
 public:
  /// Adds what bodies need, in trees some joints of which have limits, that the host's forces and torques (constants
  /// and callbacks) would move by more than constants::largest_give of their size, or turn by so many radians, in a
  /// sub-step of `h` [s], up to `highest_octave`. Free where the host gave none.
  void want(const WorldState& state, const Forest& forest, double h, std::uint8_t highest_octave,
            std::vector<Wanted>& wanted);
  std::size_t memory_bytes() const { return bytes_of(pulled_); }

 private:
  std::vector<Wanted> pulled_;  // by body row
};

}  // namespace pcphys
