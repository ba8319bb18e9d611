// Makes hulls: qhull finds the triangles, then planes become faces, and the solid's moments its frame.
#include "world/hull.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "pcphys/constants.h"
#include "world/validate.h"

namespace pcphys {
namespace {

using Point = Eigen::Vector3d;
using Polygon = std::vector<std::uint32_t>;

struct Solid {
  std::vector<Point> vertices;
  std::vector<Polygon> faces;  // counter-clockwise seen from outside
};

// ---- checks of the points --------------------------------------------------------------------------------

Error flat(const std::string& what) {
  return {ErrorCode::degenerate_shape, what + "; a hull needs four points that span a volume."};
}

Error nowhere(std::size_t points, const char* where) {
  return flat("The " + std::to_string(points) + " points of a hull " + where);
}

/// The point that is farthest by some measure.
template <class Measure> Point farthest(const std::vector<Point>& points, const Measure& measure) {
  return *std::max_element(points.begin(), points.end(),
                           [&](const Point& p, const Point& q) { return measure(p) < measure(q); });
}

/// How far the points reach apart, and from a line and a plane through some that are far apart. Each is at least half
/// of what the points are wide in some direction, and none depends on how they are turned.
struct Reach {
  double apart, from_line, from_plane;

  explicit Reach(const std::vector<Point>& points) {
    const Point first = points[0];
    const Point a = farthest(points, [&](const Point& p) { return (p - first).squaredNorm(); });
    const Point b = farthest(points, [&](const Point& p) { return (p - a).squaredNorm(); });
    apart = (b - a).norm();
    const Point along = (b - a).stableNormalized();
    const auto off_line = [&](const Point& p) { return (p - a).cross(along).norm(); };
    const Point c = farthest(points, off_line);
    from_line = off_line(c);
    const Point normal = along.cross(c - a).stableNormalized();
    const auto off_plane = [&](const Point& p) { return std::fabs(normal.dot(p - a)); };
    from_plane = off_plane(farthest(points, off_plane));
  }
};

/// Points that reach so far apart [m] are flat where they are less wide than this [m].
double least_width(double apart) { return std::max(apart * constants::hull_flatness, 2 * constants::smallest_extent); }

/// Refuses points that are surely too flat; `check_width` looks at the others once their hull is known.
Status check_reach(const Reach& reach, std::size_t points) {
  const double least = least_width(reach.apart);
  if (2 * reach.apart < least) return nowhere(points, "lie in one place");
  if (2 * reach.from_line < least) return nowhere(points, "lie on one line");
  if (2 * reach.from_plane < least) return nowhere(points, "lie in one plane");
  return {};
}

Status check_points(std::span<const Vec3> points) {
  for (const Vec3& p : points)
    if (Status ok = check_finite(p, "position of a point of a hull"); !ok) return ok;
  if (points.size() < 4)
    return flat("A hull has " + std::to_string(points.size()) + (points.size() == 1 ? " point" : " points"));
  return {};
}

// ---- faces -----------------------------------------------------------------------------------------------

struct Flat {
  double x, y;
  std::uint32_t vertex;
};
/// Twice the area of the triangle a b c over its longest side from a: how far b is from the line a c.
double bulge(const Flat& a, const Flat& b, const Flat& c) {
  const double x = c.x - a.x, y = c.y - a.y, area = (b.x - a.x) * y - (b.y - a.y) * x;
  return area / std::max(std::hypot(x, y), 1e-300);
}

/// The convex polygon around points of a plane (Andrew's monotone chain), counter-clockwise, without those that lie
/// within `tolerance` of its sides.
Polygon around(std::vector<Flat> points, double tolerance) {
  std::sort(points.begin(), points.end(),
            [](const Flat& a, const Flat& b) { return std::tie(a.x, a.y, a.vertex) < std::tie(b.x, b.y, b.vertex); });
  std::vector<Flat> ring;
  for (int pass = 0; pass < 2; pass++) {
    const std::size_t start = ring.size();
    for (const Flat& p : points) {
      while (ring.size() > start + 1 && bulge(ring[ring.size() - 2], ring.back(), p) <= 0) ring.pop_back();
      ring.push_back(p);
    }
    ring.pop_back();  // the first of the other pass
    std::reverse(points.begin(), points.end());
  }
  // not earlier: where many points stand on a line across the chains, rounding orders them
  for (std::size_t i = 0; i < ring.size() && ring.size() > 2;) {
    const std::size_t n = ring.size();
    if (bulge(ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]) <= tolerance)
      ring.erase(ring.begin() + std::ptrdiff_t(i)), i = 0;
    else
      i++;
  }
  Polygon polygon;
  for (const Flat& p : ring) polygon.push_back(p.vertex);
  return polygon;
}

/// Normal of a polygon that is plane but for rounding (Newell).
Point normal_of(const std::vector<Point>& vertices, const Polygon& polygon) {
  Point sum = Point::Zero();
  for (std::size_t i = 0; i < polygon.size(); i++)
    sum += (vertices[polygon[i]] - vertices[polygon[0]])
               .cross(vertices[polygon[(i + 1) % polygon.size()]] - vertices[polygon[0]]);
  return sum.normalized();
}

/// A plane of the hull, with area of the triangle that gave it.
struct Plane {
  double area;
  Point normal;
  std::array<std::uint32_t, 3> triangle;
};

std::vector<Plane> planes_of(const std::vector<Point>& points, const std::vector<std::uint32_t>& triangles,
                             double tolerance) {
  Point inside = Point::Zero();
  for (std::uint32_t i : triangles) inside += points[i] / double(triangles.size());
  std::vector<Plane> planes;
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const Point &a = points[triangles[i]], &b = points[triangles[i + 1]], &c = points[triangles[i + 2]];
    const Point n = (b - a).cross(c - a);
    const double longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()}));
    if (!(n.norm() > tolerance * longest)) continue;  // a sliver is part of an edge
    const double side = n.dot(a - inside) < 0 ? -1 : 1;
    planes.push_back({n.norm(), side * n.normalized(), {triangles[i], triangles[i + 1], triangles[i + 2]}});
  }
  std::stable_sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) { return a.area > b.area; });
  return planes;
}

/// The first of the vertices in each place.
Polygon apart(const std::vector<Point>& points, const Polygon& vertices, double tolerance) {
  Polygon kept;
  for (std::uint32_t v : vertices)
    if (std::none_of(kept.begin(), kept.end(),
                     [&](std::uint32_t k) { return (points[k] - points[v]).norm() < tolerance; }))
      kept.push_back(v);
  return kept;
}

/// Faces of the hull of the vertices that are left: for each plane, largest triangle first, the polygon around the
/// vertices in it. A vertex of fewer than three faces lies in a face or on an edge and goes; then all are made anew.
std::vector<Polygon> faces_of(const std::vector<Point>& points, const std::vector<Plane>& planes, Polygon& vertices,
                              double tolerance) {
  for (;;) {
    std::vector<Polygon> faces;
    std::vector<std::pair<Point, double>> taken;
    std::vector<int> uses(points.size(), 0);
    for (const Plane& plane : planes) {
      const auto in = [&](const std::pair<Point, double>& other) {
        return std::all_of(plane.triangle.begin(), plane.triangle.end(),
                           [&](std::uint32_t v) { return other.first.dot(points[v]) > other.second - tolerance; });
      };
      if (std::any_of(taken.begin(), taken.end(), in)) continue;
      double top = -1e300;
      for (std::uint32_t v : vertices) top = std::max(top, plane.normal.dot(points[v]));
      const Point u = plane.normal.unitOrthogonal(), w = plane.normal.cross(u);
      std::vector<Flat> near;
      for (std::uint32_t v : vertices)
        if (plane.normal.dot(points[v]) > top - tolerance) near.push_back({u.dot(points[v]), w.dot(points[v]), v});
      if (near.size() < 3) continue;
      Polygon face = around(std::move(near), tolerance);
      if (face.size() < 3) continue;
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      taken.push_back({plane.normal, top});
      if (std::find(faces.begin(), faces.end(), face) != faces.end()) continue;
      for (std::uint32_t v : face) uses[v]++;
      faces.push_back(std::move(face));
    }
    if (std::erase_if(vertices, [&](std::uint32_t v) { return uses[v] < 3; }) == 0) return faces;
  }
}

/// Whether every side of every face is that of one other face, run through the other way.
bool closed(const std::vector<Polygon>& faces) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const Polygon& face : faces)
    for (std::size_t i = 0; i < face.size(); i++) sides[{face[i], face[(i + 1) % face.size()]}]++;
  return faces.size() >= 4 && std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
           const auto other = sides.find({side.first.second, side.first.first});
           return side.second == 1 && other != sides.end();
         });
}

/// How far some vertex lies outside of a face: those that go one after the other may each have been near
/// what the last one left.
double sticks_out(const std::vector<Point>& points, const Polygon& vertices, const std::vector<Polygon>& faces) {
  double most = 0;
  for (const Polygon& face : faces) {
    const Point normal = normal_of(points, face);
    for (const std::uint32_t v : vertices) most = std::max(most, normal.dot(points[v] - points[face[0]]));
  }
  return most;
}

Error too_many(std::size_t points, std::size_t vertices) {
  return {ErrorCode::buffer_full, "The hull of " + std::to_string(points) + " points has " + std::to_string(vertices) +
                                      " vertices and room for " + std::to_string(constants::largest_hull_vertices) +
                                      "; leave some of the points out, or use several hulls."};
}

/// In coordinates of size 1 about the middle of the points. `extent`: how far they reach apart.
Result<Solid> solid_of(const std::vector<Point>& points, double extent) {
  std::vector<double> coordinates;
  for (const Point& p : points) coordinates.insert(coordinates.end(), p.begin(), p.end());
  const std::vector<std::uint32_t> triangles = qhull_triangles(coordinates);
  Polygon all(triangles);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all.size() > 16 * constants::largest_hull_vertices) return too_many(points.size(), all.size());
  // points of a mesh in float lie in one plane to about 1e-7; where the tolerance makes faces that do not fit
  // together, finer ones do
  for (double share = constants::hull_planarity; share > 1e-12 && !triangles.empty(); share *= 0.01) {
    const double tolerance = share * extent;
    Polygon vertices = apart(points, all, tolerance);
    const std::vector<Polygon> faces = faces_of(points, planes_of(points, triangles, tolerance), vertices, tolerance);
    if (!closed(faces) || sticks_out(points, all, faces) > 4 * tolerance) continue;
    if (vertices.size() > constants::largest_hull_vertices) return too_many(points.size(), vertices.size());
    Solid solid;
    std::vector<std::uint32_t> number(points.size(), 0);
    for (std::uint32_t v : vertices) {
      number[v] = std::uint32_t(solid.vertices.size());
      solid.vertices.push_back(points[v]);
    }
    for (const Polygon& face : faces) {
      solid.faces.push_back(face);
      for (std::uint32_t& v : solid.faces.back()) v = number[v];
    }
    return solid;
  }
  return Error{ErrorCode::degenerate_shape,
               "The points of a hull are too close together for faces between them; weld them first."};
}

/// Refuses a solid that is too flat across one of its faces, or too large, whichever way it is turned. In no direction
/// is it much less wide than across that face. `size`: of its unit of length [m].
Status check_width(const Solid& solid, double size, std::size_t points) {
  double width = 1e300, apart = 0;
  for (const Polygon& face : solid.faces) {
    const Point normal = normal_of(solid.vertices, face), on = solid.vertices[face[0]];
    double deepest = 0;
    for (const Point& p : solid.vertices) deepest = std::max(deepest, normal.dot(on - p));
    width = std::min(width, deepest);
  }
  for (const Point& p : solid.vertices)
    for (const Point& q : solid.vertices) apart = std::max(apart, (p - q).norm());
  if (!(size * width >= least_width(size * apart))) return nowhere(points, "lie in one plane");
  if (size * apart > 2 * constants::largest_extent)
    return Error{ErrorCode::degenerate_shape,
                 "The " + std::to_string(points) +
                     " points of a hull lie more than 2e6 m apart; a shape's half extents may "
                     "be up to 1e6 m."};
  return {};
}

// ---- the frame -------------------------------------------------------------------------------------------

/// Integrals over the solid: of 1, of x, and of x x^T about the centre of mass.
struct Moments {
  double volume = 0;
  Point centre = Point::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};
/// Exact, by tetrahedra from the origin to a triangle of each face.
Moments integrate(const Solid& solid) {
  Moments m;
  for (const Polygon& face : solid.faces)
    for (std::size_t i = 1; i + 1 < face.size(); i++) {
      const Point &a = solid.vertices[face[0]], &b = solid.vertices[face[i]], &c = solid.vertices[face[i + 1]];
      const double six = a.dot(b.cross(c));
      const Point sum = a + b + c;
      m.volume += six / 6;
      m.centre += six / 24 * sum;
      m.second += six / 120 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
  m.centre /= m.volume;
  m.second -= m.volume * m.centre * m.centre.transpose();
  return m;
}

/// The principal axes as columns, in the order and with the signs that turn the given axes least. Axes that are
/// principal already stay.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& second) {
  const Eigen::Matrix3d off = second - Eigen::Matrix3d(second.diagonal().asDiagonal());
  if (off.cwiseAbs().maxCoeff() < 1e-12 * second.trace()) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d found = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvectors();
  Eigen::Matrix3d best = found;
  double most = -4;
  std::array<int, 3> order{0, 1, 2};
  do
    for (int signs = 0; signs < 8; signs++) {
      Eigen::Matrix3d axes;
      for (int k = 0; k < 3; k++) axes.col(k) = (signs >> k & 1 ? -1 : 1) * found.col(order[std::size_t(k)]);
      if (axes.determinant() > 0 && axes.trace() > most + 1e-9) {
        most = axes.trace();
        best = axes;
      }
    }
  while (std::next_permutation(order.begin(), order.end()));
  return best;
}

}  // namespace

Result<Hull> make_hull(std::span<const Vec3> points) try {
  if (Status ok = check_points(points); !ok) return ok.error();
  const std::vector<Point> given(points.begin(), points.end());
  const Reach reach(given);
  if (Status ok = check_reach(reach, given.size()); !ok) return ok.error();
  Eigen::AlignedBox3d box;
  for (const Point& p : given) box.extend(p);
  const Point middle = box.center();
  const double size = box.sizes().maxCoeff();
  std::vector<Point> scaled;
  for (const Point& p : given) scaled.push_back((p - middle) / size);
  Result<Solid> made = solid_of(scaled, reach.apart / size);
  if (!made) return made.error();
  Solid& solid = *made;
  if (Status ok = check_width(solid, size, given.size()); !ok) return ok.error();

  const Moments m = integrate(solid);
  const Eigen::Matrix3d axes = principal_axes(m.second);
  for (Point& p : solid.vertices) p = size * (axes.transpose() * (p - m.centre));
  auto data = std::make_shared<HullData>();
  data->volume = m.volume * size * size * size;
  const Point along = (axes.transpose() * m.second * axes).diagonal() * (size * size * size * size * size);
  data->moments = {along.y() + along.z(), along.x() + along.z(), along.x() + along.y()};
  data->frame = {Vec3(Point(middle + size * m.centre)), Quat(Eigen::Quaterniond(axes).normalized())};
  data->inner_radius = 1e300;
  data->first = {0};
  for (const Point& p : solid.vertices) {
    data->vertices.push_back(p);
    data->radius = std::max(data->radius, p.norm());
  }
  for (const Polygon& face : solid.faces) {
    data->corners.insert(data->corners.end(), face.begin(), face.end());
    data->first.push_back(std::uint32_t(data->corners.size()));
    const Point n = normal_of(solid.vertices, face);
    data->normals.push_back(n);
    data->inner_radius = std::min(data->inner_radius, n.dot(solid.vertices[face[0]]));
  }
  write_table(*data);
  return Hull(std::move(data));
} catch (...) {
  return caught();
}

std::span<const Vec3> Hull::vertices() const {
  return data_ ? std::span<const Vec3>(data_->vertices) : std::span<const Vec3>();
}
std::size_t Hull::face_count() const { return data_ ? data_->normals.size() : 0; }
std::span<const std::uint32_t> Hull::face(std::size_t i) const { return data_->face(i); }
double Hull::volume() const { return data_ ? data_->volume : 0; }
Vec3 Hull::moments() const { return data_ ? data_->moments : Vec3{}; }
double Hull::radius() const { return data_ ? data_->radius : 0; }
double Hull::inner_radius() const { return data_ ? data_->inner_radius : 0; }
Pose Hull::frame() const { return data_ ? data_->frame : Pose{}; }

}  // namespace pcphys
