// Sub-step classes: an island of octave k makes 2^k times the sub-steps that the settings ask for, and all others go on
// as they are (docs/substeps.md); of fourth order the octave counts from octave_count on (plan/island_class.h). Chosen
// before the step from what the world's tables hold, so that it is the same on any backend.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pcphys/step.h"
#include "plan/columns.h"
#include "plan/islands.h"
#include "plan/loads.h"
#include "plan/loops.h"
#include "plan/pulls.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class Forest;
class TreeNodes;

/// Of a step, whatever asks for them.
inline constexpr std::uint32_t most_substeps = 1000;

/// The highest octave within StepSettings::refinement and the most sub-steps of a step.
std::uint8_t highest_octave(const StepSettings& settings);
/// Of loops: further, up to constants::most_loop_substeps, unless `refinement` switches octaves off.
std::uint8_t highest_loop_octave(const StepSettings& settings);

class Octaves {
 public:
  /// Follows a change of objects, as Loops::find.
  void update_structure(const WorldState& state, const SolvedJoints& joints, std::span<const std::uint32_t> pulling,
                        std::span<const char> parallel) {
    loops_.find(state, joints, pulling, parallel);
  }
  /// Follows a change of contacts. `uneven`: masses differ.
  void update_contacts(const WorldState& state, const TreeNodes& trees, bool uneven);
  /// Of a step of `dt`. `faces`: some contact has more than one point, so that something may stand on something. False:
  /// they are those of the step before. `fourth`: the trees of fourth order. `together`: all bodies act on each other,
  /// and have one octave.
  bool choose(const WorldState& state, const Forest& forest, const TreeNodes& trees, bool faces,
              std::span<const std::uint32_t> fourth, bool together, const StepSettings& settings, double dt);

  /// Before the first try of a step.
  void begin() { again_.clear(); }
  /// After a try: whether the step is to be made again, with more sub-steps. `poses`: those before it, if kept.
  bool find_tighter(const WorldState& state, const Forest& forest, const AlignedBytes* poses);

  /// By body row its class; empty: all are of octave 0.
  std::span<const std::uint8_t> of_bodies() const { return of_bodies_; }
  /// Bit k: some body that moves is of class k; where none does bit 0 alone.
  std::uint32_t used() const { return used_; }
  /// How many bodies are of a higher octave than 0.
  std::uint32_t refined() const { return refined_; }
  /// How many are in islands that would have got more, had there been more to get.
  std::uint32_t limited() const { return limited_; }
  /// How many are of fourth order.
  std::uint32_t fourth_order() const { return fourth_order_; }
  std::size_t memory_bytes() const {
    return bytes_of(loads_, loops_, columns_, pulls_, islands_, wanted_, again_, of_bodies_, before_, limits_);
  }

 private:
  void assign(const WorldState& state, bool together);
  void count_limited();

  Loads loads_;
  Loops loops_;
  Columns columns_;
  Pulls pulls_;
  Islands islands_;
  std::vector<Wanted> wanted_;
  std::vector<Wanted> again_;  // of bodies for which a try of this step was made with too few
  double h_ = 0;               // of octave 0 in the last `choose`, as are
  std::uint8_t highest_ = 0, highest_of_loops_ = 0;
  std::vector<std::uint8_t> of_bodies_, before_;
  std::vector<std::uint32_t> limits_;  // roots of islands that would have got more
  std::uint32_t used_ = 1, refined_ = 0, limited_ = 0, fourth_order_ = 0;
};

}  // namespace pcphys
