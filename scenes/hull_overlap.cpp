#include "hull_overlap.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace pcphys::scenes {
namespace {

/// In world axes.
struct Placed {
  std::vector<Vec3> vertices, normals, edges;
};

Placed place(const Hull& hull, const Pose& pose) {
  Placed placed;
  for (const Vec3& v : hull.vertices()) placed.vertices.push_back(transform(pose, v));
  for (std::size_t f = 0; f < hull.face_count(); ++f) {
    const auto face = hull.face(f);
    const Vec3 a = placed.vertices[face[0]], out = cross(placed.vertices[face[1]] - a, placed.vertices[face[2]] - a);
    placed.normals.push_back((1 / length(out)) * out);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t from = face[k], to = face[(k + 1) % face.size()];
      if (from < to) placed.edges.push_back(placed.vertices[to] - placed.vertices[from]);
    }
  }
  return placed;
}

/// How far b would have to move along n to be beyond a.
double depth(const Placed& a, const Placed& b, Vec3 n) {
  double top = -std::numeric_limits<double>::infinity(), bottom = -top;
  for (const Vec3& v : a.vertices) top = std::max(top, dot(n, v));
  for (const Vec3& v : b.vertices) bottom = std::min(bottom, dot(n, v));
  return top - bottom;
}

}  // namespace

double overlap(const Hull& a, const Pose& pose_a, const Hull& b, const Pose& pose_b) {
  if (length(pose_b.position - pose_a.position) >= a.radius() + b.radius()) return 0;
  const Placed x = place(a, pose_a), y = place(b, pose_b);
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& n : x.normals) least = std::min(least, depth(x, y, n));
  for (const Vec3& n : y.normals) least = std::min(least, depth(y, x, n));
  if (least <= 0) return 0;
  for (const Vec3& u : x.edges)
    for (const Vec3& v : y.edges) {
      const Vec3 c = cross(u, v);
      const double l = length(c);
      if (l < 1e-9 * length(u) * length(v)) continue;
      const Vec3 n = (1 / l) * c;
      least = std::min({least, depth(x, y, n), depth(y, x, n)});
      if (least <= 0) return 0;
    }
  return least;
}

}  // namespace pcphys::scenes
