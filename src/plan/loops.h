// Sub-steps for what pulls: a joint that stands in no tree (it closes a loop, or gives way) and a spring between two
// points need sub-steps that resolve how fast their bodies swing in them (docs/joint-trees.md). They are chosen by the
// tension that a step left.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pcphys/step.h"
#include "plan/solved_joints.h"
#include "plan/wanted.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class Loops {
 public:
  /// Follows a change of objects. `pulling`: rows of the joints that stand in no tree, and of springs. `parallel`: by
  /// row, whether another joint holds the same two bodies already, so that this one lets nothing swing.
  void find(const WorldState& state, const SolvedJoints& joints, std::span<const std::uint32_t> pulling,
            std::span<const char> parallel);
  /// Adds what sub-steps of `h` need, up to `highest` octaves, for the tension that impulses of sub-steps of
  /// `impulse_h` were of.
  void want(const WorldState& state, double impulse_h, double h, std::uint8_t highest,
            std::vector<Wanted>& wanted) const;
  std::size_t memory_bytes() const { return bytes_of(loops_); }

 private:
  struct Loop {
    std::uint32_t joint, body;
    double ratio;  // of the square of the frequency at which its lighter body swings, and the force [1/(kg m)]
  };

  std::vector<Loop> loops_;
};

}  // namespace pcphys
