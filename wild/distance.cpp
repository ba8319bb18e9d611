#include "wild/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "wild/shapes.h"

namespace pcphys::wild {
namespace {

/// What is round about a shape: the rest is a point, a segment or a body with corners.
double roundness(const ShapeDef& s) {
  return s.kind == ShapeKind::sphere || s.kind == ShapeKind::capsule ? s.size.x : 0;
}

/// The point of the shape's core that is furthest along a direction of the shape's own axes.
Vec3 support_inside(const ShapeDef& s, Vec3 d) {
  switch (s.kind) {
    case ShapeKind::capsule: return {0, std::copysign(s.size.y, d.y), 0};
    case ShapeKind::box:
      return {std::copysign(s.size.x, d.x), std::copysign(s.size.y, d.y), std::copysign(s.size.z, d.z)};
    case ShapeKind::cylinder: {
      const double across = std::hypot(d.x, d.z), scale = across > 0 ? s.size.x / across : 0;
      return {d.x * scale, std::copysign(s.size.y, d.y), d.z * scale};
    }
    case ShapeKind::hull: {
      Vec3 best;
      double most = -std::numeric_limits<double>::infinity();
      for (const Vec3 v : s.convex.vertices()) {
        const double along = dot(v, d);
        if (along <= most) continue;
        most = along;
        best = v;
      }
      return best;
    }
    default: return {};
  }
}

Vec3 support(const Placed& p, Vec3 direction) {
  return transform(p.pose, support_inside(*p.shape, rotate(conjugate(p.pose.orientation), direction)));
}

/// Up to four points of the difference of two cores, and the point of their hull that is nearest to the origin.
class Simplex {
 public:
  void add(Vec3 p) { points_[count_++] = p; }
  bool has(Vec3 p) const { return std::find(points_, points_ + count_, p) != points_ + count_; }
  bool full() const { return count_ == 4; }

  /// Keeps the fewest points whose hull has the nearest point, and returns it.
  Vec3 nearest() {
    best_squared_ = std::numeric_limits<double>::infinity();
    best_count_ = 0;
    if (full() && inside()) return {};
    for (int i = 0; i < count_; i++) try_point(i);
    for (int i = 0; i < count_; i++)
      for (int j = i + 1; j < count_; j++) try_edge(i, j);
    for (int i = 0; i < count_; i++)
      for (int j = i + 1; j < count_; j++)
        for (int k = j + 1; k < count_; k++) try_face(i, j, k);
    Vec3 kept[3];
    for (int i = 0; i < best_count_; i++) kept[i] = points_[best_[i]];
    std::copy(kept, kept + best_count_, points_);
    count_ = best_count_;
    return nearest_;
  }

 private:
  void offer(Vec3 p, int i, int j, int k) {
    const double squared = dot(p, p);
    if (squared >= best_squared_) return;
    best_squared_ = squared;
    nearest_ = p;
    best_[0] = i;
    best_[1] = j;
    best_[2] = k;
    best_count_ = 1 + (j >= 0) + (k >= 0);
  }
  void try_point(int i) { offer(points_[i], i, -1, -1); }
  void try_edge(int i, int j) {
    const Vec3 a = points_[i], edge = points_[j] - a;
    const double squared = dot(edge, edge);
    if (squared <= 0) return;
    const double t = -dot(a, edge) / squared;
    if (t > 0 && t < 1) offer(a + t * edge, i, j, -1);
  }
  void try_face(int i, int j, int k) {
    const Vec3 a = points_[i], b = points_[j], c = points_[k], n = cross(b - a, c - a);
    const double squared = dot(n, n);
    if (squared <= 0) return;
    const Vec3 p = n * (dot(a, n) / squared);
    const bool within =
        dot(cross(b - a, p - a), n) > 0 && dot(cross(c - b, p - b), n) > 0 && dot(cross(a - c, p - c), n) > 0;
    if (within) offer(p, i, j, k);
  }
  /// Whether the origin is in the tetrahedron: on the inner side of each face.
  bool inside() const {
    for (int i = 0; i < 4; i++) {
      const Vec3 a = points_[(i + 1) % 4], b = points_[(i + 2) % 4], c = points_[(i + 3) % 4], n = cross(b - a, c - a);
      const double own = dot(n, points_[i] - a), origin = -dot(n, a);
      if (own * origin <= 0) return false;
    }
    return true;
  }

  Vec3 points_[4], nearest_;
  int count_ = 0, best_[3] = {}, best_count_ = 0;
  double best_squared_ = 0;
};

double core_distance(const Placed& a, const Placed& b) {
  Simplex simplex;
  Vec3 v = a.pose.position - b.pose.position;
  if (v == Vec3{}) v = {1, 0, 0};
  double bound = 0;
  for (int i = 0; i < 100; i++) {
    const Vec3 w = support(a, -v) - support(b, v);
    const double far = length(v);
    if (far == 0) return 0;
    if (i > 0 || !simplex.full()) bound = std::max(bound, dot(v, w) / far);
    if (simplex.has(w) || (i > 0 && far - bound <= 1e-10 * far)) break;
    simplex.add(w);
    const Vec3 next = simplex.nearest();
    if (next == Vec3{}) return 0;
    if (i > 0 && dot(next, next) >= dot(v, v)) break;  // rounding: nothing is nearer
    v = next;
  }
  return bound;
}

/// Of what is furthest below along the plane's normal.
double above_plane(const Placed& plane, const Placed& other) {
  const Vec3 n = rotate(plane.pose.orientation, {0, 1, 0});
  const Vec3 lowest = support(other, -n);
  return std::max(0.0, dot(n, lowest - plane.pose.position) - roundness(*other.shape));
}

Pose after(const Moving& m, double t) {
  const double turn = length(m.angular_velocity) * t;
  Pose pose{m.body.position + m.velocity * t, m.body.orientation};
  if (turn > 0) pose.orientation = axis_angle(m.angular_velocity * (t / turn), turn) * pose.orientation;
  return pose;
}

}  // namespace

double distance(const Placed& a, const Placed& b) {
  if (a.shape->kind == ShapeKind::plane) return b.shape->kind == ShapeKind::plane ? 0 : above_plane(a, b);
  if (b.shape->kind == ShapeKind::plane) return above_plane(b, a);
  return std::max(0.0, core_distance(a, b) - roundness(*a.shape) - roundness(*b.shape));
}

double least_distance(const Moving& a, const Moving& b, double seconds, double near) {
  const auto outer = [](const Moving& m) {
    return m.shape->kind == ShapeKind::plane ? 0 : length(m.shape->local.position) + outer_radius(*m.shape);
  };
  const double fastest =
      length(a.velocity - b.velocity) + length(a.angular_velocity) * outer(a) + length(b.angular_velocity) * outer(b);
  double least = std::numeric_limits<double>::infinity();
  double t = 0;
  for (int i = 0; i < 200; i++) {
    const double apart = distance(placed(*a.shape, after(a, t)), placed(*b.shape, after(b, t)));
    least = std::min(least, apart);
    if (least <= near || t >= seconds || fastest <= 0) return least;
    t = std::min(seconds, t + std::max((apart - 0.5 * near) / fastest, 1e-6 * seconds));
  }
  return near;  // not told apart from meeting within so many looks
}

}  // namespace pcphys::wild
