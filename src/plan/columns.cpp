#include "plan/columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcphys/constants.h"
#include "plan/octaves.h"
#include "plan/tree_paths.h"

namespace pcphys {
namespace {

Vec3 upward(const WorldState& state) {
  const double g = length(state.gravity);
  return g > 0 ? (-1 / g) * state.gravity : Vec3{};
}

/// Twice the largest radius of gyration [m].
double size_of(const WorldState& state, std::uint32_t body) {
  const Vec3 moments = state.tables.get3(Buffer::mass, body, 0);
  return 2 * std::sqrt(std::max({moments.x, moments.y, moments.z}) * state.tables.get(Buffer::motion, body, 3));
}

bool stands_free(const WorldState& state, const TreeNodes& trees, std::uint32_t body) {
  return state.responds(body) && trees.node(body) == 0;
}

}  // namespace

void Columns::find(const WorldState& state, const TreeNodes& trees, bool faces) {
  columns_.clear();
  smallest_ = 0;
  if (!faces) return;
  const Vec3 up = upward(state);
  low_ = std::numeric_limits<double>::infinity();
  high_ = -low_;
  double smallest = low_;
  for (std::uint32_t row = 1; row < state.bodies.size(); row++) {
    if (!stands_free(state, trees, row)) continue;
    const double height = dot(up, state.tables.get3(Buffer::pose, row, 0));
    low_ = std::min(low_, height);
    high_ = std::max(high_, height);
    smallest = std::min(smallest, size_of(state, row));
  }
  if (high_ >= low_) smallest_ = smallest;
}

void Columns::measure(const WorldState& state, const TreeNodes& trees, Islands& islands) {
  islands.build(state);
  columns_.assign(state.bodies.size(), {});
  const Vec3 up = upward(state);
  for (std::uint32_t row = 1; row < state.bodies.size(); row++) {
    if (!stands_free(state, trees, row)) continue;
    Column& column = columns_[islands.root(row)];
    const double height = dot(up, state.tables.get3(Buffer::pose, row, 0));
    column.low = column.bodies == 0 ? height : std::min(column.low, height);
    column.high = column.bodies == 0 ? height : std::max(column.high, height);
    column.sizes += size_of(state, row);
    column.bodies++;
  }
}

void Columns::want(const WorldState& state, const TreeNodes& trees, double h, std::uint8_t highest_octave, Islands& islands,
                   std::vector<Wanted>& wanted) {
  if (smallest_ == 0 || highest_octave == 0) return;
  const double frequency = constants::contact_frequency_times_h / h;
  // how far the weight of one body presses in one as heavy [m]
  const double give = length(state.gravity) / (frequency * frequency);
  if ((high_ - low_) * give <= constants::column_overlap * smallest_ * smallest_) return;
  if (columns_.empty()) measure(state, trees, islands);
  for (std::uint32_t root = 1; root < columns_.size(); root++) {
    const Column& column = columns_[root];
    if (column.bodies == 0) continue;
    const double size = column.sizes / column.bodies;
    const double overlap = give * std::min((column.high - column.low) / size, double(column.bodies));
    if (overlap <= constants::column_overlap * size) continue;
    if (const std::uint8_t octave = octave_for(overlap, constants::column_aim * size, highest_octave); octave > 0)
      wanted.push_back({root, octave, true});
  }
}

}  // namespace pcphys
