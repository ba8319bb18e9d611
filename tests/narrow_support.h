// Random pairs of shapes in strata.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "fcl/fcl_narrow.h"
#include "narrow_distance.h"

namespace narrow_test {

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
