// A pile of random convex hulls, of 16 forms that the bodies share.
#include <algorithm>
#include <cmath>

#include "builder.h"

namespace pcphys::scenes {
namespace {

constexpr int forms = 16;
constexpr double spacing = 1.05;  // more than the largest diameter [m]

/// Up to 32 points in and on an ellipsoid with half axes of 0.2 to 0.4 m; every fourth form is a block with six faces.
std::vector<Vec3> points(Random& random, int form) {
  const double x = random.between(0.2, 0.4), y = random.between(0.2, 0.4), z = random.between(0.2, 0.4);
  std::vector<Vec3> result;
  if (form % 4 == 0) {
    for (int i = 0; i < 8; ++i) {
      const double top = i & 2 ? 0.8 : 1;
      result.push_back({(i & 1 ? x : -x) * top, i & 2 ? y : -y, (i & 4 ? z : -z) * top});
    }
    return result;
  }
  const int count = 8 + 2 * (form % 13);
  while (int(result.size()) < count) {
    const double a = random.between(-1, 1), b = random.between(-1, 1), c = random.between(-1, 1);
    const double l = std::sqrt(a * a + b * b + c * c);
    if (!(l > 0.1 && l < 1)) continue;
    const Vec3 point{x * a / l, y * b / l, z * c / l};
    result.push_back(point);
    result.push_back(-random.between(0.6, 1) * point);  // about its middle: slivers would be light under heavy ones
  }
  return result;
}

}  // namespace

void build_hulls(Builder& builder) {
  const int count = builder.scene().count;
  const double width = std::max(1.2, 0.393 * std::sqrt(double(count)));
  const int n = std::max(1, int(std::floor((width - 0.1) / spacing))), per_layer = n * n;
  builder.set_material(0.5, 0);
  builder.add_open_box(width, 1.0 + spacing * ((count + per_layer - 1) / per_layer) + 20.0);

  Random random = builder.random(2718);
  std::vector<Hull> hulls;
  for (int form = 0; form < forms; ++form) {
    auto hull = make_hull(points(random, form));
    if (!hull) return builder.fail(hull.error());
    hulls.push_back(*hull);
  }
  for (int i = 0; i < count; ++i) {
    BodyDef def;
    def.shapes = {ShapeDef::hull(hulls[std::size_t(i % forms)])};
    const int cell = i % per_layer;
    def.pose.position = {(cell % n - 0.5 * (n - 1)) * spacing, 1.0 + spacing * (i / per_layer),
                         (cell / n - 0.5 * (n - 1)) * spacing};
    const double a = random.between(-1, 1), b = random.between(-1, 1), c = random.between(-1, 1),
                 d = random.between(0.1, 1);
    const double l = std::sqrt(a * a + b * b + c * c + d * d);
    def.pose.orientation = {a / l, b / l, c / l, d / l};
    builder.add(def);
  }
}

}  // namespace pcphys::scenes
