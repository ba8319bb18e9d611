// What the tests of the narrow phase compare with: separation along a normal from support functions, its largest value
// over all normals by brute force, and bounds of the distance.
#pragma once
#include <algorithm>
#include <random>

#include "narrow_shapes.h"

namespace narrow_test {

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

}  // namespace narrow_test
