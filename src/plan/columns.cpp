#include "plan/columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcphys/constants.h"
#include "plan/octaves.h"
#include "plan/tree_paths.h"

namespace pcphys {

namespace {
constexpr std::uint32_t none = ~0u;

/// How far its mass extends along a direction: twice the radius of gyration for bodies of equal moments, and by the
/// second moment of mass along the direction, tr(I) / 2 - u I u, for others.
/// A beam that lies is as high as it is thick.
double size_along(const WorldState& state, std::uint32_t row, Vec3 up) {
  const Vec3 u = rotate(conjugate(state.orientation(row)), up), m = state.tables.get3(Buffer::mass, row, 0);
  const double second = 0.5 * (m.x + m.y + m.z) - (m.x * u.x * u.x + m.y * u.y * u.y + m.z * u.z * u.z);
  return 2 * std::sqrt(2 * std::max(second, 0.0) * state.tables.get(Buffer::motion, row, 3));
}
}  // namespace

void Columns::list(const WorldState& state, const TreeNodes& trees, Islands& islands) {
  islands.build(state);
  listed_ = true;
  bodies_.clear();
  columns_.clear();
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
    const bool even = moments.x == moments.y && moments.y == moments.z;
    const double size = even ? state.size(row) : 0;
    columns_[column_of_[root]].bodies++;
    bodies_.push_back({row, column_of_[root], size});
  }
}

void Columns::want(const WorldState& state, const TreeNodes& trees, double h, std::uint8_t highest_octave,
                   Islands& islands, std::vector<Wanted>& wanted) {
  const double g = length(state.gravity), frequency = constants::soft_frequency_times_h / h;
  if (g == 0 || highest_octave == 0) return;
  if (!listed_) list(state, trees, islands);
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (Column& column : columns_) {
    std::ranges::fill(column.low, infinite);
    std::ranges::fill(column.high, -infinite);
    column.sizes = 0;
    column.faces = false;
  }
  for (std::uint32_t contact = 1; contact < state.contact_rows(); contact++) {
    if (state.tables.get(Buffer::contact, contact, 3) < 2) continue;
    for (const std::uint32_t body : state.contacts.ends[contact])
      if (state.responds(body) && column_of_[islands.root(body)] != none)
        columns_[column_of_[islands.root(body)]].faces = true;
  }
  const Vec3 up = (-1 / g) * state.gravity;
  const Vec3 beside = std::fabs(up.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 across = (1 / length(cross(up, beside))) * cross(up, beside), axes[] = {up, across, cross(up, across)};
  for (const Body& body : bodies_) {
    const Vec3 at = state.tables.get3(Buffer::pose, body.row, 0);
    Column& column = columns_[body.column];
    column.sizes += body.size > 0 ? body.size : size_along(state, body.row, up);
    for (int k = 0; k < 3; k++) {
      const double x = dot(axes[k], at);
      column.low[k] = std::min(column.low[k], x);
      column.high[k] = std::max(column.high[k], x);
    }
  }
  // how far the weight of one body presses in one as heavy [m]
  const double give = g / (frequency * frequency);
  const auto want = [&](std::uint32_t root, double share, double most) {
    if (const std::uint8_t octave = octave_for(share, most, highest_octave); octave > 0)
      wanted.push_back({root, octave});
  };
  for (const Column& column : columns_) {
    if (!column.faces) continue;
    const double size = column.sizes / column.bodies, height = column.extent(0),
                 high = std::min(height / size, double(column.bodies));
    const double wide = std::max(column.extent(1), column.extent(2)) + size;
    want(column.root, give * high / size, constants::largest_give);
    want(column.root, give * high * high * height / (wide * wide), constants::largest_give);
  }
}

}  // namespace pcphys
