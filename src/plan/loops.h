// Sub-steps for loops under tension: a joint that closes one needs sub-steps that resolve how fast its bodies swing in it
// (docs/joint-trees.md). They are chosen by the tension of the step before, and where the step itself brings more, it is made again.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pcphys/step.h"
#include "plan/solved_joints.h"
#include "plan/wanted.h"
#include "world/state.h"

namespace pcphys {

class Loops {
 public:
  /// Follows a change of objects. `closing`: rows of the joints that close loops and that trees answer.
  void find(const WorldState& state, const SolvedJoints& joints, std::span<const std::uint32_t> closing);
  /// A step begins, whose tensions are not known yet.
  void begin();
  /// Adds what sub-steps of `h` need for the tension of the last step, up to `highest` octaves, and all of these where a try of this step
  /// brought more. What it brings where sub-steps are too few says nothing of how many it needs.
  void want(const WorldState& state, double h, std::uint8_t highest, std::vector<Wanted>& wanted);
  /// After a try: whether some loop came under a tension that asks for more than it got.
  bool find_tighter(const WorldState& state);

 private:
  struct Loop {
    std::uint32_t joint, body;
    double ratio;        // of the square of the frequency at which its lighter body swings, and the force [1/(kg m)]
    double assumed = 0;  // tension that the step is made for [N]
    bool tight = false;  // a try of it brought more
  };
  double tension(const WorldState& state, const Loop& loop, double h) const;
  std::uint8_t octave(const Loop& loop, double tension, std::uint8_t highest) const;

  std::vector<Loop> loops_;
  double h_ = 0;  // of the last `want`, as are
  std::uint8_t highest_ = 0;
};

}  // namespace pcphys
