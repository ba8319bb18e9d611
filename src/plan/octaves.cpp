#include "plan/octaves.h"

#include <algorithm>

#include "pcphys/constants.h"
#include "plan/forest.h"
#include "plan/infos.h"
#include "plan/island_class.h"
#include "plan/passed_limits.h"
#include "plan/spins.h"

namespace pcphys {

std::uint8_t highest_octave(const StepSettings& settings) {
  std::uint8_t octave = 0;
  while (octave + 1u < octave_count && 2u << octave <= settings.refinement &&
         settings.substeps << (octave + 1) <= most_substeps)
    octave++;
  return octave;
}

std::uint8_t highest_loop_octave(const StepSettings& settings) {
  std::uint8_t octave = highest_octave(settings);
  while (octave > 0 && octave + 1u < octave_count && settings.substeps << (octave + 1) <= constants::most_loop_substeps)
    octave++;
  return octave;
}

void Octaves::update_contacts(const WorldState& state, const TreeNodes& trees, bool uneven) {
  columns_.forget();
  islands_.forget();
  uneven ? loads_.find(state, trees, islands_) : loads_.forget_contacts();
}

bool Octaves::choose(const WorldState& state, const Forest& forest, const TreeNodes& trees, bool faces,
                     std::span<const std::uint32_t> fourth, bool together, const StepSettings& settings, double dt) {
  wanted_.clear();
  const std::uint8_t highest = settings.integrator == Integrator::seed ? 0 : highest_octave(settings);
  const std::uint8_t beyond = highest > 0 ? std::uint8_t(highest + 1) : highest;
  const double h = substep_length(dt, settings.substeps);
  const double soft = soft_substep_length(state.soft_substep, h, dt);
  loads_.want(state, soft, beyond, wanted_);
  if (faces) columns_.want(state, trees, soft, beyond, islands_, wanted_);
  want_for_spins(state, forest, islands_, h, beyond, wanted_);
  pulls_.want(state, forest, h, beyond, wanted_);
  for (Wanted& w : wanted_) {
    w.more = w.octave > highest;
    w.octave = std::min(w.octave, highest);
  }
  h_ = h, highest_ = highest;
  highest_of_loops_ = highest > 0 ? highest_loop_octave(settings) : highest;
  loops_.want(state, state.last_substep, h, highest_of_loops_, wanted_);
  wanted_.insert(wanted_.end(), again_.begin(), again_.end());
  before_.swap(of_bodies_);
  of_bodies_.clear();
  used_ = 1;
  refined_ = limited_ = fourth_order_ = 0;
  if (!wanted_.empty() || !fourth.empty()) of_bodies_.assign(state.bodies.size(), 0);
  if (!wanted_.empty()) assign(state, together);
  for (const std::uint32_t tree : fourth)  // each is an island
    for (const TreeNode& node : forest.tree(tree)) {
      if (!state.responds(node.body)) continue;
      of_bodies_[node.body] += octave_count;
      fourth_order_++;
    }
  if (!of_bodies_.empty()) {
    used_ = 0;
    for (std::uint32_t row = 1; row < of_bodies_.size(); row++)
      if (state.goes(row)) used_ |= 1u << of_bodies_[row];
    if (used_ == 0) used_ = 1;  // nobody moves: whatever else there is to do is of octave 0
  }
  return !std::ranges::equal(before_, of_bodies_);
}

/// Each island gets the highest octave that one of its bodies asks for.
void Octaves::assign(const WorldState& state, bool together) {
  islands_.build(state);
  std::uint8_t highest_of_all = 0;
  limits_.clear();
  for (const Wanted& w : wanted_) {
    const std::uint32_t root = islands_.root(w.body);
    of_bodies_[root] = std::max(of_bodies_[root], w.octave);
    highest_of_all = std::max(highest_of_all, of_bodies_[root]);
    if (w.more) limits_.push_back(root);
  }
  count_limited();
  for (std::uint32_t row = 1; row < of_bodies_.size(); row++) {
    if (!state.goes(row)) continue;
    // a root is the lowest row of its island
    of_bodies_[row] = together ? highest_of_all : of_bodies_[islands_.root(row)];
    refined_ += of_bodies_[row] > 0;
  }
}

void Octaves::count_limited() {
  std::ranges::sort(limits_);
  limits_.erase(std::unique(limits_.begin(), limits_.end()), limits_.end());
  for (const std::uint32_t root : limits_) limited_ += islands_.size(root);
}

bool Octaves::find_tighter(const WorldState& state, const Forest& forest, const AlignedBytes* poses) {
  const auto made = [&](const Wanted& w) { return of_bodies_.empty() ? 0u : octave_of(of_bodies_[w.body]); };
  wanted_.clear();
  constexpr std::uint8_t most = 2;  // so that the step takes five times what it did at most
  if (poses && again_.empty()) want_for_passed_limits(state, forest, *poses, std::min(highest_, most), wanted_);
  for (Wanted& w : wanted_) w.octave = std::uint8_t(std::min<unsigned>(highest_, made(w) + w.octave));
  want_for_spins(state, forest, islands_, h_, highest_, wanted_);
  loops_.want(state, h_, h_, highest_of_loops_, wanted_);
  const std::size_t before = again_.size();
  for (const Wanted& w : wanted_)
    if (w.octave > made(w)) again_.push_back(w);
  return again_.size() > before;
}

}  // namespace pcphys
