// A hull as numbers for the narrow phase, in the layout of src/kernels/narrow/narrow_hull.inl.
#include <algorithm>
#include <cmath>
#include <set>

#include "pcphys/constants.h"
#include "world/hull.h"

namespace pcphys {
namespace {

void push(std::vector<double>& reals, Vec3 v) { reals.insert(reals.end(), {v.x, v.y, v.z}); }

/// Up to so many corners of a face, evenly spread.
std::vector<Vec3> some_corners(const HullData& hull, std::size_t face) {
  const auto all = hull.face(face);
  const std::size_t count = std::min<std::size_t>(all.size(), constants::largest_hull_face);
  std::vector<Vec3> corners;
  for (std::size_t k = 0; k < count; k++) corners.push_back(hull.vertices[all[k * all.size() / count]]);
  return corners;
}

/// Row of a face and rows of its sides, in the plane's own coordinates about the mean of its corners.
void add_face(const HullData& hull, std::size_t face, std::vector<double>& faces, std::vector<double>& sides) {
  const std::vector<Vec3> corners = some_corners(hull, face);
  const std::size_t count = corners.size();
  Vec3 centre;
  for (const Vec3& c : corners) centre = centre + (1.0 / double(count)) * c;
  const Vec3 n = hull.normals[face], along = corners[1] - corners[0];
  const Vec3 straight = along - dot(along, n) * n, e1 = (1 / length(straight)) * straight, e2 = cross(n, e1);
  double area = 0;
  for (std::size_t k = 0; k < count; k++) {
    const Vec3 a = corners[k] - centre, b = corners[(k + 1) % count] - centre;
    const double ax = dot(a, e1), ay = dot(a, e2), dx = dot(b, e1) - ax, dy = dot(b, e2) - ay,
                 side = std::hypot(dx, dy);
    const double nx = dy / side, ny = -dx / side;
    sides.insert(sides.end(), {ax, ay, nx, ny, nx * ax + ny * ay});
    area += 0.5 * (ax * dy - ay * dx);
  }
  push(faces, n);
  push(faces, e1);
  push(faces, e2);
  push(faces, centre);
  faces.push_back(0.5 * std::sqrt(area));
}

}  // namespace

void write_table(HullData& hull) {
  const std::size_t vertices = hull.vertices.size(), faces = hull.normals.size();
  std::vector<std::set<std::uint32_t>> neighbours(vertices);
  for (std::size_t f = 0; f < faces; f++) {
    const auto face = hull.face(f);
    for (std::size_t k = 0; k < face.size(); k++) {
      neighbours[face[k]].insert(face[(k + 1) % face.size()]);
      neighbours[face[(k + 1) % face.size()]].insert(face[k]);
    }
  }
  std::vector<double> reals, rows, sides;
  std::vector<std::uint32_t>& indices = hull.table.indices;
  indices = {std::uint32_t(vertices), std::uint32_t(faces)};
  for (const Vec3& v : hull.vertices) push(reals, v);
  const std::size_t sides_begin = 3 * vertices + 13 * faces;
  for (std::size_t f = 0; f < faces; f++) {
    indices.push_back(std::uint32_t(sides_begin + sides.size()));
    add_face(hull, f, rows, sides);
  }
  indices.push_back(std::uint32_t(sides_begin + sides.size()));
  reals.insert(reals.end(), rows.begin(), rows.end());
  reals.insert(reals.end(), sides.begin(), sides.end());
  std::uint32_t next = std::uint32_t(indices.size() + vertices + 1);
  for (const auto& of : neighbours) {
    indices.push_back(next);
    next += std::uint32_t(of.size());
  }
  indices.push_back(next);
  for (const auto& of : neighbours) indices.insert(indices.end(), of.begin(), of.end());
  hull.table.f64 = reals;
  hull.table.f32.assign(reals.begin(), reals.end());
}

}  // namespace pcphys
