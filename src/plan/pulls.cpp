#include "plan/pulls.h"

#include <algorithm>

#include "pcphys/constants.h"
#include "plan/forest.h"

namespace pcphys {

namespace {

/// How far a sub-step of `h` would take the body: in sizes of it (twice its radius of gyration), or radians,
/// whichever is more.
double pull(const WorldState& state, std::uint32_t row, double h) {
  const double size = state.size(row);
  if (!(size > 0)) return 0;  // it does not rotate: no joint holds it by an angle
  const double way = length(state.given_force(row)) * state.tables.get(Buffer::motion, row, 3) / size;
  return h * h * std::max(way, length(state.spin_of(row, state.given_torque(row))));
}

}  // namespace

void Pulls::want(const WorldState& state, const Forest& forest, double h, std::uint8_t highest_octave,
                 std::vector<Wanted>& wanted) {
  if (forest.trees() == 0 || highest_octave == 0) return;
  pulled_.clear();
  for (const ForceRecord& force : state.forces) {
    const std::uint32_t row = state.body_ids.row(force.body);
    if (row == 0 || !state.responds(row)) continue;  // 0: the force was removed
    const double most = pull(state, row, h);
    if (const std::uint8_t octave = octave_for(most, constants::largest_give, highest_octave); octave > 0)
      pulled_.push_back({row, octave});
  }
  if (pulled_.empty()) return;
  std::ranges::sort(pulled_, {}, &Wanted::body);
  for (std::size_t i = 0; i < forest.trees(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    for (const TreeNode& node : tree) {
      const auto found = std::ranges::lower_bound(pulled_, node.body, {}, &Wanted::body);
      if (found == pulled_.end() || found->body != node.body || !has_limits(state, tree)) continue;
      wanted.push_back(*found);
    }
  }
}

}  // namespace pcphys
