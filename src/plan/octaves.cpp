#include "plan/octaves.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pcphys/constants.h"
#include "plan/forest.h"
#include "plan/infos.h"
#include "plan/island_class.h"
#include "plan/spins.h"

namespace pcphys {

void Islands::build(const WorldState& state) {
  if (std::exchange(built_, true)) return;
  parent_.resize(state.bodies.size());
  std::iota(parent_.begin(), parent_.end(), 0u);
  size_.assign(parent_.size(), 1);
  const auto join_moving = [&](std::uint32_t a, std::uint32_t b) {
    if (!state.stands(a) && !state.stands(b)) join(a, b);
  };
  for (const auto& [a, b] : state.contacts.ends) join_moving(a, b);
  for (std::uint32_t row = 1; row < state.joints.size(); row++)
    join_moving(state.body_ids.row(state.joints[row].body_a), state.body_ids.row(state.joints[row].body_b));
}

std::uint32_t Islands::root(std::uint32_t body) const {
  while (parent_[body] != body) body = parent_[body];
  return body;
}

void Islands::join(std::uint32_t a, std::uint32_t b) {
  const auto find = [&](std::uint32_t body) {
    for (; parent_[body] != body; body = parent_[body]) parent_[body] = parent_[parent_[body]];
    return body;
  };
  a = find(a);
  b = find(b);
  if (a == b) return;
  if (a > b) std::swap(a, b);
  parent_[b] = a;
  size_[a] += size_[b];
}

std::uint8_t highest_octave(const StepSettings& settings) {
  std::uint8_t octave = 0;
  while (octave + 1u < octave_count && 2u << octave <= settings.refinement && settings.substeps << (octave + 1) <= most_substeps)
    octave++;
  return octave;
}

void Octaves::update_contacts(const WorldState& state, const TreeNodes& trees, bool uneven) {
  uneven ? loads_.find(state, trees) : loads_.forget_contacts();
  columns_.forget();
  islands_.forget();
}

bool Octaves::choose(const WorldState& state, const Forest& forest, const TreeNodes& trees, bool faces,
                     std::span<const std::uint32_t> fourth, bool together, const StepSettings& settings, double dt) {
  wanted_.clear();
  const std::uint8_t highest = settings.integrator == Integrator::seed ? 0 : highest_octave(settings);
  loads_.want(state, settings, dt, highest, wanted_);
  const double h = substep_length(dt, settings.substeps);
  if (faces) columns_.want(state, trees, h, highest, islands_, wanted_);
  want_for_spins(state, forest, h, highest, wanted_);
  before_.swap(of_bodies_);
  of_bodies_.clear();
  used_ = 1;
  refined_ = fourth_order_ = 0;
  if (!wanted_.empty() || !fourth.empty()) of_bodies_.assign(state.bodies.size(), 0);
  if (!wanted_.empty()) {
    islands_.build(state);
    std::uint8_t highest_of_all = 0;
    for (const Wanted& w : wanted_) {
      const std::uint32_t root = islands_.root(w.body);
      const bool whole = w.any_size || islands_.size(root) <= constants::large_island;
      of_bodies_[root] = std::max(of_bodies_[root], whole ? w.octave : std::uint8_t{1});
      highest_of_all = std::max(highest_of_all, of_bodies_[root]);
    }
    for (std::uint32_t row = 1; row < of_bodies_.size(); row++) {
      if (!state.goes(row)) continue;
      of_bodies_[row] = together ? highest_of_all : of_bodies_[islands_.root(row)];  // a root is the lowest row of its island
      refined_ += of_bodies_[row] > 0;
    }
  }
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
  }
  return !std::ranges::equal(before_, of_bodies_);
}

}  // namespace pcphys
