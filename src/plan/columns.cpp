#include "plan/columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcphys/constants.h"
#include "plan/octaves.h"
#include "plan/tree_paths.h"

namespace pcphys {

void Columns::list(const WorldState& state, const TreeNodes& trees, Islands& islands) {
  islands.build(state);
  listed_ = true;
  bodies_.clear();
  columns_.clear();
  constexpr std::uint32_t none = ~0u;
  column_of_.assign(state.bodies.size(), none);
  for (std::uint32_t row = 1; row < state.bodies.size(); row++) {
    if (!state.responds(row) || trees.node(row) > 0 || state.asleep(row)) continue;
    const std::uint32_t root = islands.root(row);
    if (islands.size(root) < 2) continue;
    if (column_of_[root] == none) {
      column_of_[root] = std::uint32_t(columns_.size());
      columns_.push_back({root});
    }
    const Vec3 moments = state.tables.get3(Buffer::mass, row, 0);
    const double size = 2 * std::sqrt(std::max({moments.x, moments.y, moments.z}) * state.tables.get(Buffer::motion, row, 3));
    Column& column = columns_[column_of_[root]];
    column.bodies++;
    column.sizes += size;
    bodies_.push_back({row, column_of_[root]});
  }
}

void Columns::want(const WorldState& state, const TreeNodes& trees, double h, std::uint8_t highest_octave, Islands& islands,
                   std::vector<Wanted>& wanted) {
  const double g = length(state.gravity), frequency = constants::contact_frequency_times_h / h;
  if (g == 0 || highest_octave == 0) return;
  if (!listed_) list(state, trees, islands);
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (Column& column : columns_) column.low = infinite, column.high = -infinite;
  const Vec3 up = (-1 / g) * state.gravity;
  for (const Body& body : bodies_) {
    const double height = dot(up, state.tables.get3(Buffer::pose, body.row, 0));
    Column& column = columns_[body.column];
    column.low = std::min(column.low, height);
    column.high = std::max(column.high, height);
  }
  // how far the weight of one body presses in one as heavy [m]
  const double give = g / (frequency * frequency);
  const auto want = [&](std::uint32_t root, double share, double most, double aim) {
    if (share <= most) return;
    if (const std::uint8_t octave = octave_for(share, aim, highest_octave); octave > 0) wanted.push_back({root, octave, true});
  };
  for (const Column& column : columns_) {
    const double size = column.sizes / column.bodies, high = std::min((column.high - column.low) / size, double(column.bodies));
    want(column.root, give * high / size, constants::column_overlap, constants::column_aim);
    if (column.bodies <= constants::small_island)
      want(column.root, 0.5 * give * high * high / size, constants::column_sag, constants::sag_aim);
  }
}

}  // namespace pcphys
