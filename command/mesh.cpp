#include "mesh.h"

#include <cmath>
#include <numbers>

namespace pcphys::command {
namespace {

constexpr int around = 20;         // vertices about the axis of a round shape
constexpr int per_quarter = 5;     // rings from pole to equator
constexpr double plane_half = 50;  // of an endless plane, this much is drawn [m]

std::uint16_t add_vertex(Mesh& mesh, Vec3 p, Vec3 n) {
  for (double x : {p.x, p.y, p.z}) mesh.positions.push_back(float(x));
  for (double x : {n.x, n.y, n.z}) mesh.normals.push_back(float(x));
  return std::uint16_t(mesh.positions.size() / 3 - 1);
}

void add_triangle(Mesh& mesh, std::uint16_t a, std::uint16_t b, std::uint16_t c) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c});
}

/// A face with centre c and half sides u, v; u x v points outwards.
void add_face(Mesh& mesh, Vec3 c, Vec3 u, Vec3 v) {
  const Vec3 out = cross(u, v);
  const Vec3 n = (1 / length(out)) * out;
  const std::uint16_t first = add_vertex(mesh, c - u - v, n);
  add_vertex(mesh, c + u - v, n);
  add_vertex(mesh, c + u + v, n);
  add_vertex(mesh, c - u + v, n);
  add_triangle(mesh, first, std::uint16_t(first + 1), std::uint16_t(first + 2));
  add_triangle(mesh, first, std::uint16_t(first + 2), std::uint16_t(first + 3));
}

Mesh box(Vec3 h) {
  Mesh mesh;
  const Vec3 x{h.x, 0, 0}, y{0, h.y, 0}, z{0, 0, h.z};
  add_face(mesh, x, y, z);
  add_face(mesh, -x, z, y);
  add_face(mesh, y, z, x);
  add_face(mesh, -y, x, z);
  add_face(mesh, z, x, y);
  add_face(mesh, -z, y, x);
  return mesh;
}

/// A point of the outline that is turned about y: its place, and its normal's part outwards and upwards.
struct Outline {
  double radius, y, outwards, upwards;
};

/// Rings from top to bottom. A band between two rings of the same place is an edge and gets no triangles.
Mesh lathe(const std::vector<Outline>& outline) {
  Mesh mesh;
  for (const Outline& o : outline)
    for (int k = 0; k <= around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around, c = std::cos(angle), s = std::sin(angle);
      add_vertex(mesh, {o.radius * c, o.y, o.radius * s}, {o.outwards * c, o.upwards, o.outwards * s});
    }
  for (std::size_t ring = 0; ring + 1 < outline.size(); ++ring) {
    const Outline &upper = outline[ring], &lower = outline[ring + 1];
    if (upper.radius == lower.radius && upper.y == lower.y) continue;
    for (int k = 0; k < around; ++k) {
      const auto a = std::uint16_t(int(ring) * (around + 1) + k), b = std::uint16_t(a + around + 1);
      if (upper.radius > 0) add_triangle(mesh, a, std::uint16_t(a + 1), b);
      if (lower.radius > 0) add_triangle(mesh, std::uint16_t(a + 1), std::uint16_t(b + 1), b);
    }
  }
  return mesh;
}

Mesh capsule(double radius, double half_length) {
  std::vector<Outline> outline;
  for (int side : {1, -1})
    for (int k = 0; k <= per_quarter; ++k) {
      const double angle = 0.5 * std::numbers::pi * (side > 0 ? k : per_quarter - k) / per_quarter;  // from the pole
      const double s = k == (side > 0 ? 0 : per_quarter) ? 0 : std::sin(angle), c = side * std::cos(angle);
      if (side < 0 && k == 0 && half_length == 0) continue;  // a sphere has one equator
      outline.push_back({radius * s, side * half_length + radius * c, s, c});
    }
  return lathe(outline);
}

Mesh cylinder(double radius, double half_height) {
  return lathe({{0, half_height, 0, 1},
                {radius, half_height, 0, 1},
                {radius, half_height, 1, 0},
                {radius, -half_height, 1, 0},
                {radius, -half_height, 0, -1},
                {0, -half_height, 0, -1}});
}

Mesh hull(const Hull& hull) {
  Mesh mesh;
  const auto vertices = hull.vertices();
  for (std::size_t f = 0; f < hull.face_count(); ++f) {
    const auto face = hull.face(f);
    const Vec3 out = cross(vertices[face[1]] - vertices[face[0]], vertices[face[2]] - vertices[face[0]]);
    const Vec3 n = (1 / length(out)) * out;
    std::uint16_t first = 0, previous = 0;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint16_t corner = add_vertex(mesh, vertices[face[k]], n);
      if (k == 0) first = corner;
      if (k > 1) add_triangle(mesh, first, previous, corner);
      previous = corner;
    }
  }
  return mesh;
}

Mesh plane() {
  Mesh mesh;
  add_face(mesh, {}, {0, 0, plane_half}, {plane_half, 0, 0});
  return mesh;
}

}  // namespace

Mesh make_mesh(const ShapeDef& shape) {
  switch (shape.kind) {
    case ShapeKind::sphere: return capsule(shape.size.x, 0);
    case ShapeKind::capsule: return capsule(shape.size.x, shape.size.y);
    case ShapeKind::box: return box(shape.size);
    case ShapeKind::cylinder: return cylinder(shape.size.x, shape.size.y);
    case ShapeKind::hull: return hull(shape.convex);
    case ShapeKind::plane: break;
  }
  return plane();
}

}  // namespace pcphys::command
