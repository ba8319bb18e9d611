// Random pairs of shapes in strata, and what the tests of the narrow phase compare with: separation along a
// normal from support functions, and its largest value over all normals by brute force.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision/narrow.h"
#include "fcl/fcl_narrow.h"
#include "world/hull.h"

namespace narrow_test {
using namespace pcphys;
using Shape = ShapeView<double>;

inline const std::array<const char*, 6> kind_names{"sphere", "capsule", "box", "cylinder", "hull", "plane"};
inline std::string pair_name(ShapeKind a, ShapeKind b) {
  return std::string(kind_names[int(a)]) + "-" + kind_names[int(b)];
}

inline Vec3 vec(const double* p) { return {p[0], p[1], p[2]}; }
inline Vec3 centre(const Shape& s) { return vec(s.p); }
inline Quat turn(const Shape& s) { return {s.q[0], s.q[1], s.q[2], s.q[3]}; }
inline Shape shape(ShapeKind kind, Vec3 size, Vec3 p = {}, Quat q = {}) {
  return {kind, {size.x, size.y, size.z}, {p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}};
}
/// The shape as it is, elsewhere.
inline Shape posed(Shape s, Vec3 p = {}, Quat q = {}) {
  Shape out = shape(s.kind, vec(s.size), p, q);
  out.hull = s.hull;
  return out;
}
/// A view of the hull of some points, which lives until the program ends.
inline Shape hull_shape(const std::vector<Vec3>& points, Vec3 p = {}, Quat q = {}) {
  static std::deque<Hull> kept;
  Result<Hull> made = make_hull(points);
  if (!made) throw std::runtime_error(made.error().message);
  kept.push_back(std::move(*made));
  Shape s = shape(ShapeKind::hull, {kept.back().radius(), kept.back().inner_radius(), 0}, p, q);
  s.hull = kept.back().data();
  return s;
}
inline std::vector<Vec3> box_corners(Vec3 h) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; i++) points.push_back({i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z});
  return points;
}
inline void move(Shape& s, Vec3 d) {
  s.p[0] += d.x;
  s.p[1] += d.y;
  s.p[2] += d.z;
}
inline void place(Shape& s, Vec3 p) {
  s.p[0] = p.x;
  s.p[1] = p.y;
  s.p[2] = p.z;
}
inline Shape turned(Shape s, Quat q, Vec3 shift) {
  const Vec3 p = rotate(q, centre(s)) + shift;
  const Quat r = q * turn(s);
  return posed(s, p, r);
}
inline ShapeView<float> to_float(const Shape& s) {
  return {s.kind,
          {float(s.size[0]), float(s.size[1]), float(s.size[2])},
          {float(s.p[0]), float(s.p[1]), float(s.p[2])},
          {float(s.q[0]), float(s.q[1]), float(s.q[2]), float(s.q[3])},
          s.hull};
}
inline Shape to_double(const ShapeView<float>& s) {
  const Quat q{s.q[0], s.q[1], s.q[2], s.q[3]};
  const double n = 1 / length(q);  // a float's quaternion is a unit to 1e-7 only
  return {s.kind,
          {s.size[0], s.size[1], s.size[2]},
          {s.p[0], s.p[1], s.p[2]},
          {n * q.x, n * q.y, n * q.z, n * q.w},
          s.hull};
}
template <class S> Vec3 normal(const Manifold<S>& m) {
  return {double(m.normal[0]), double(m.normal[1]), double(m.normal[2])};
}
template <class S> Vec3 point(const Manifold<S>& m, std::uint32_t i) {
  return {double(m.points[i].p[0]), double(m.points[i].p[1]), double(m.points[i].p[2])};
}
template <class S> double deepest(const Manifold<S>& m) {
  double s = 1e30;
  for (std::uint32_t i = 0; i < m.count; i++) s = std::min(s, double(m.points[i].separation));
  return s;
}
template <class S> std::set<std::uint32_t> features(const Manifold<S>& m) {
  std::set<std::uint32_t> f;
  for (std::uint32_t i = 0; i < m.count; i++) f.insert(m.points[i].feature);
  return f;
}
template <class S> bool finite(const Manifold<S>& m) {
  bool ok = m.count <= 4;
  if (m.count > 0) ok = ok && pcphys::finite(normal(m)) && std::abs(length(normal(m)) - 1) < 1e-5;
  for (std::uint32_t i = 0; ok && i < m.count; i++)
    ok = pcphys::finite(point(m, i)) && std::isfinite(m.points[i].separation);
  return ok;
}
inline Manifold<double> find(const Shape& a, const Shape& b, double margin) {
  Manifold<double> m;
  std::uint32_t hint = 0;
  narrow(a, b, margin, hint, m);
  return m;
}
inline Manifold<float> find(const ShapeView<float>& a, const ShapeView<float>& b, float margin) {
  Manifold<float> m;
  std::uint32_t hint = 0;
  narrow(a, b, margin, hint, m);
  return m;
}

// ---- support functions: written apart from the kernels ---------------------------------------------------
inline double reach(const Shape& s, Vec3 n) {  // max over the shape of n . (x - centre)
  const Vec3 l = rotate(conjugate(turn(s)), n);
  switch (s.kind) {
    case ShapeKind::sphere: return s.size[0];
    case ShapeKind::capsule: return s.size[0] + s.size[1] * std::abs(l.y);
    case ShapeKind::box: return s.size[0] * std::abs(l.x) + s.size[1] * std::abs(l.y) + s.size[2] * std::abs(l.z);
    case ShapeKind::cylinder: return s.size[0] * std::hypot(l.x, l.z) + s.size[1] * std::abs(l.y);
    case ShapeKind::hull: {
      double most = 0;
      for (const Vec3& v : s.hull->vertices) most = std::max(most, dot(v, l));
      return most;
    }
    case ShapeKind::plane: return 0;
  }
  return 0;
}
/// Separation of the two slabs square to n: never above the true distance, and its largest value is that.
inline double separation_along(const Shape& a, const Shape& b, Vec3 n) {
  return dot(n, centre(b) - centre(a)) - reach(a, n) - reach(b, -n);
}

struct Best {
  double separation;
  Vec3 normal;
};
/// Largest separation over all normals: a spiral of directions, then the best few refined at random.
inline Best brute_force(const Shape& a, const Shape& b) {
  constexpr int directions = 200, starts = 4;
  std::array<std::pair<double, Vec3>, directions> tried;
  for (int i = 0; i < directions; i++) {
    const double y = 1 - 2 * (i + 0.5) / directions, r = std::sqrt(1 - y * y), t = 2.39996322972865332 * i;
    const Vec3 n{r * std::cos(t), y, r * std::sin(t)};
    tried[std::size_t(i)] = {separation_along(a, b, n), n};
  }
  std::partial_sort(tried.begin(), tried.begin() + starts, tried.end(),
                    [](const auto& x, const auto& y) { return x.first > y.first; });
  std::mt19937 random(7);
  std::uniform_real_distribution<double> one(-1, 1);
  Best best{-1e30, {}};
  for (int k = 0; k < starts; k++) {
    auto [s, n] = tried[std::size_t(k)];
    int missed = 0;
    for (double step = 0.2; step > 1e-9;) {
      Vec3 c = n + step * Vec3{one(random), one(random), one(random)};
      c = 1 / length(c) * c;
      const double t = separation_along(a, b, c);
      if (t > s) {
        s = t;
        n = c;
        missed = 0;
        step *= 1.3;
      } else if (++missed > 12) {
        step *= 0.5;
        missed = 0;
      }
    }
    if (s > best.separation) best = {s, n};
  }
  return best;
}

/// The point of a triangle nearest to x: over its face, or on one of its sides.
inline Vec3 nearest_on_triangle(Vec3 a, Vec3 b, Vec3 c, Vec3 x) {
  const Vec3 n = cross(b - a, c - a), foot = x - dot(x - a, n) / dot(n, n) * n;
  const std::array<Vec3, 3> corners{a, b, c};
  bool over = true;
  Vec3 best = a;
  for (std::size_t i = 0; i < 3; i++) {
    const Vec3 p = corners[i], e = corners[(i + 1) % 3] - p;
    over = over && dot(cross(e, foot - p), n) >= 0;
    const Vec3 on = p + std::clamp(dot(x - p, e) / dot(e, e), 0.0, 1.0) * e;
    if (length(on - x) < length(best - x)) best = on;
  }
  return over ? foot : best;
}
inline Vec3 nearest_in_hull(const HullData& hull, Vec3 x) {
  Vec3 best;
  double least = 1e300;
  bool inside = true;
  for (std::size_t f = 0; f < hull.normals.size(); f++) {
    const auto face = hull.face(f);
    if (dot(x - hull.vertices[face[0]], hull.normals[f]) <= 0) continue;
    inside = false;
    for (std::size_t k = 1; k + 1 < face.size(); k++) {
      const Vec3 on =
          nearest_on_triangle(hull.vertices[face[0]], hull.vertices[face[k]], hull.vertices[face[k + 1]], x);
      if (length(on - x) < least) {
        least = length(on - x);
        best = on;
      }
    }
  }
  return inside ? x : best;
}
/// The point of a shape nearest to x: closed forms.
inline Vec3 nearest(const Shape& s, Vec3 x) {
  Vec3 l = rotate(conjugate(turn(s)), x - centre(s));
  const auto shrink = [&](Vec3 from, double r) {  // onto the ball about `from`
    const Vec3 d = l - from;
    const double n = length(d);
    return n > r ? from + (r / n) * d : l;
  };
  if (s.kind == ShapeKind::sphere) l = shrink({}, s.size[0]);
  if (s.kind == ShapeKind::capsule) l = shrink({0, std::clamp(l.y, -s.size[1], s.size[1]), 0}, s.size[0]);
  if (s.kind == ShapeKind::box)
    l = {std::clamp(l.x, -s.size[0], s.size[0]), std::clamp(l.y, -s.size[1], s.size[1]),
         std::clamp(l.z, -s.size[2], s.size[2])};
  if (s.kind == ShapeKind::cylinder) {
    const double rho = std::hypot(l.x, l.z), k = rho > s.size[0] ? s.size[0] / rho : 1;
    l = {k * l.x, std::clamp(l.y, -s.size[1], s.size[1]), k * l.z};
  }
  if (s.kind == ShapeKind::hull) l = nearest_in_hull(*s.hull, l);
  return centre(s) + rotate(turn(s), l);
}
/// Never below the distance of shapes that are apart: alternating projections with a growing stride.
inline Best alternating(const Shape& a, const Shape& b) {
  Vec3 x = nearest(a, centre(b)), y = nearest(b, x);
  double best = length(y - x), stride = 1;
  for (int i = 0; i < 400; i++) {
    const Vec3 next = nearest(a, y);
    Vec3 ahead = nearest(a, x + stride * (next - x)), b1 = nearest(b, ahead), b2 = nearest(b, next);
    if (length(b1 - ahead) <= length(b2 - next)) {
      x = ahead;
      y = b1;
      stride *= 1.5;
    } else {
      x = next;
      y = b2;
      stride = 1;
    }
    const double d = length(y - x);
    if (d < 1e-12 || (i > 30 && best - d < 1e-15)) {
      best = std::min(best, d);
      break;
    }
    best = std::min(best, d);
  }
  return {best, best > 0 ? 1 / length(y - x) * (y - x) : Vec3{}};
}

/// What is known of the signed distance: at least `low`, and at most `high` when the shapes are apart.
struct Bounds {
  double low, high;
  Vec3 normal;
};
inline Bounds bounds(const Shape& a, const Shape& b) {
  const Best apart = alternating(a, b);
  if (apart.separation > 1e-7) {
    const Vec3 n = apart.normal;
    return {separation_along(a, b, n), apart.separation, n};
  }
  const Best best = brute_force(a, b);
  return {best.separation, apart.separation, best.normal};
}

// ---- random pairs ------------------------------------------------------------------------------------------
enum class Stratum { anywhere, near_touching, deep, parallel, aligned, coincident, uneven };
inline const std::array<Stratum, 7> strata{Stratum::anywhere, Stratum::near_touching, Stratum::deep,  Stratum::parallel,
                                           Stratum::aligned,  Stratum::coincident,    Stratum::uneven};
inline const std::array<const char*, 7> stratum_names{"anywhere", "near_touching", "deep",  "parallel",
                                                      "aligned",  "coincident",    "uneven"};

inline double smallest(const Shape& s) {
  switch (s.kind) {
    case ShapeKind::box: return std::min({s.size[0], s.size[1], s.size[2]});
    case ShapeKind::cylinder: return std::min(s.size[0], s.size[1]);
    case ShapeKind::hull: return s.size[1];
    default: return s.size[0];
  }
}
/// What tolerances are relative to: the smaller shape's largest extent.
inline double scale(const Shape& a, const Shape& b) {
  const auto extent = [](const Shape& s) {
    return s.kind == ShapeKind::sphere || s.kind == ShapeKind::hull ? s.size[0]
           : s.kind == ShapeKind::capsule                           ? s.size[0] + s.size[1]
           : s.kind == ShapeKind::box                               ? std::max({s.size[0], s.size[1], s.size[2]})
                                                                    : std::max(s.size[0], s.size[1]);
  };
  return std::min(extent(a), extent(b));
}

class Pairs {
 public:
  explicit Pairs(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 ball(double r) { return {between(-r, r), between(-r, r), between(-r, r)}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = ball(1);
      const double l = length(v);
      if (l > 0.1 && l < 1) return 1 / l * v;
    }
  }
  Quat rotation() { return axis_angle(direction(), between(0, 3.14159265)); }
  /// Boxes, prisms, tetrahedra, and points on an ellipsoid, all off centre.
  std::vector<Vec3> points() {
    const int form = int(between(0, 4));
    const Vec3 size{between(0.1, 0.5), between(0.1, 0.5), between(0.1, 0.5)};
    std::vector<Vec3> points;
    if (form == 0) points = box_corners(size);
    if (form == 1) {
      const int sides = int(between(3, 25));
      for (int i = 0; i < 2 * sides; i++) {
        const double t = 6.283185307179586 * (i / 2) / sides;
        points.push_back({size.x * std::cos(t), i % 2 ? size.y : -size.y, size.x * std::sin(t)});
      }
    }
    if (form >= 2) {
      const int count = form == 2 ? 4 : int(between(6, 40));
      for (int i = 0; i < count; i++) {
        const Vec3 d = form == 2 && i == 0 ? Vec3{0, 1, 0} : direction();
        points.push_back({size.x * d.x, size.y * d.y, size.z * d.z});
      }
    }
    const Vec3 shift = ball(1);
    for (Vec3& p : points) p = p + shift;
    return points;
  }
  Shape random_hull() {
    for (;;) {
      const std::vector<Vec3> p = points();
      const auto made = make_hull(p);
      if (made && made->inner_radius() > 0.02) return hull_shape(p, {}, rotation());
    }
  }
  Shape random_shape(ShapeKind kind) {
    if (kind == ShapeKind::hull) return random_hull();
    const auto s = [&] { return between(0.1, 0.5); };
    const Vec3 size = kind == ShapeKind::sphere ? Vec3{s(), 0, 0}
                      : kind == ShapeKind::box  ? Vec3{s(), s(), s()}
                                                : Vec3{s(), s(), 0};
    return shape(kind, size, {}, rotation());
  }
  std::pair<Shape, Shape> pair(ShapeKind ka, ShapeKind kb, Stratum stratum) {
    Shape a = random_shape(ka), b = random_shape(kb);
    if (stratum == Stratum::uneven) {  // a floor or a pole
      for (int i = 0; i < 3; i++)
        if (kb == ShapeKind::box && between(0, 1) < 0.6) b.size[i] *= between(1, 200);
      if (kb == ShapeKind::capsule || kb == ShapeKind::cylinder) b.size[1] *= between(1, 50);
    }
    if (stratum == Stratum::parallel)
      b = posed(b, {}, axis_angle(direction(), between(0, 1) < 0.5 ? 0 : std::pow(10, between(-7, -1))) * turn(a));
    if (stratum == Stratum::aligned) {
      a = posed(a);
      const double quarter = 1.57079632679489662 * std::floor(between(0, 4));
      const std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
      b = posed(b, {}, axis_angle(axes[std::size_t(between(0, 2.999))], quarter));
    }
    if (stratum == Stratum::coincident) {
      if (between(0, 1) < 0.5) b = posed(b, {}, turn(a));
      return {a, b};
    }
    if (stratum == Stratum::deep) {
      place(b, ball(0.1));
      return {a, b};
    }
    if (stratum == Stratum::uneven && kb == ShapeKind::box) {  // somewhere over one of its faces
      const int i = int(between(0, 2.999));
      Vec3 l{b.size[0] * between(-1, 1), b.size[1] * between(-1, 1), b.size[2] * between(-1, 1)};
      (i == 0 ? l.x : i == 1 ? l.y : l.z) = b.size[i] * (between(0, 1) < 0.5 ? -1 : 1);
      place(b, -rotate(turn(b), l));
    }
    const Vec3 d = direction();
    // from the centre outward until the shapes are about as far apart as wanted
    const double want = stratum == Stratum::near_touching ? 0 : between(-0.1, 0.08);
    if (stratum != Stratum::uneven) place(b, (between(0.3, 1) * (reach(a, d) + reach(b, -d))) * d);
    for (int k = 0; k < 2; k++) {
      const Bounds now = bounds(a, b);
      move(b, (want - now.low) * now.normal);
      if (k == 0 && stratum == Stratum::near_touching) move(b, 0.01 * now.normal);
      if (k == 1 && stratum == Stratum::near_touching)
        move(b, (std::pow(10, between(-7, -2)) * (between(0, 1) < 0.5 ? -1 : 1)) * now.normal);
    }
    return {a, b};
  }

 private:
  std::mt19937 random_;
};

}  // namespace narrow_test
