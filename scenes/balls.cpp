// Bouncing balls (section 10.1 of the original). The box is as wide as keeps the filling the same for any
// number of balls: 0.393 m per square root of their number is the original's box at 60 balls.
#include <algorithm>
#include <cmath>

#include "builder.h"

namespace pcphys::scenes {
namespace {

constexpr double spacing = 1.05;  // a little more than the largest diameter [m]

struct Cell {
  int x, z;
};

/// The cells of an n x n grid along a square spiral, centre outwards.
std::vector<Cell> spiral(int n) {
  const int low = -((n - 1) / 2), high = low + n - 1;
  const auto inside = [&](Cell c) { return c.x >= low && c.x <= high && c.z >= low && c.z <= high; };
  std::vector<Cell> cells;
  Cell at{0, 0}, heading{1, 0};
  for (int leg = 0; cells.size() < std::size_t(n) * std::size_t(n); ++leg) {
    for (int k = 0; k <= leg / 2; ++k) {
      if (inside(at)) cells.push_back(at);
      at = {at.x + heading.x, at.z + heading.z};
    }
    heading = {-heading.z, heading.x};
  }
  return cells;
}

}  // namespace

void build_balls(Builder& builder) {
  const int count = builder.scene().count;
  const double width = std::max(1.2, 0.393 * std::sqrt(double(count)));  // wide enough for one ball when there are few
  const int n = std::max(1, int(std::floor((width - 0.1) / spacing)));
  const int per_layer = n * n, layers = (count + per_layer - 1) / per_layer;
  builder.set_material(0.5, 0.95);
  builder.add_open_box(width, 1.0 + spacing * layers + 20.0);

  Random random = builder.random(12345);
  const std::vector<Cell> cells = spiral(n);
  const double centre = n % 2 == 0 ? -0.5 : 0.0;  // of the grid, in cells
  const double speed = 5.0 / std::sqrt(3.0);      // at most 5 m/s in all
  for (int i = 0; i < count; ++i) {
    const Cell cell = cells[std::size_t(i % per_layer)];
    BodyDef def;
    def.shapes = {ShapeDef::sphere(random.between(0.1, 0.5))};
    def.velocity.x = random.between(-speed, speed);
    def.velocity.y = random.between(-speed, speed);
    def.velocity.z = random.between(-speed, speed);
    def.pose.position = {(cell.x + centre) * spacing, 1.0 + spacing * (i / per_layer), (cell.z + centre) * spacing};
    builder.add(def);
  }
}

}  // namespace pcphys::scenes
