// The inside of a hull: its polyhedron, and the same as numbers that the narrow phase indexes.
#pragma once
#include <cstdint>
#include <vector>

#include "pcphys/hull.h"

namespace pcphys {

/// Laid out as src/kernels/narrow/narrow_hull.inl says. Indices into the reals do not depend on the precision.
struct HullTable {
  std::vector<float> f32;
  std::vector<double> f64;
  std::vector<std::uint32_t> indices;

  void reals_of(const float*& reals) const { reals = f32.data(); }
  void reals_of(const double*& reals) const { reals = f64.data(); }
};

struct HullData {
  std::vector<Vec3> vertices;          // own frame
  std::vector<std::uint32_t> corners;  // vertices of the faces, one face after the other
  std::vector<std::uint32_t> first;    // of a face in `corners`; one more than there are faces
  std::vector<Vec3> normals;           // of the faces, outward
  double volume = 0, radius = 0, inner_radius = 0;
  Vec3 moments;  // of a density of 1
  Pose frame;
  HullTable table;

  std::span<const std::uint32_t> face(std::size_t i) const {
    return std::span(corners).subspan(first[i], first[i + 1] - first[i]);
  }
};

/// Triangles of the convex hull of `count` points (x y z, one after the other), as indices of them; empty when qhull
/// gives up. Triangles of one plane stand side by side, some without area.
std::vector<std::uint32_t> qhull_triangles(std::vector<double>& coordinates);

/// Fills in `table` from the rest.
void write_table(HullData& hull);

}  // namespace pcphys
