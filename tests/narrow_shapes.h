// Shapes and manifolds as the tests of the narrow phase make and read them.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision/narrow.h"
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

}  // namespace narrow_test
