// When and how two shapes meet that move fast for their size: conservative advancement (B. Mirtich, 1996). The manifold
// of that instant stands in for the one at the step's start, whose normal would turn before they touch.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "collision/mover.h"
#include "collision/narrow.h"
#include "collision/support_gap.h"

namespace pcphys {

template <class Scalar> Scalar least_separation(const Manifold<Scalar>& m) {
  Scalar least = m.points[0].separation;
  for (std::uint32_t i = 1; i < m.count; i++) least = std::min(least, m.points[i].separation);
  return least;
}

/// The manifold of time t as seen from the start: gaps open again with the speeds of the points, arms go back by the
/// first body's share of the way.
template <class Scalar>
void back_to_start(const TwistOf<Scalar>& a, const TwistOf<Scalar>& b, const Scalar* apart, double share, double t,
                   Manifold<Scalar>& m) {
  Scalar path[3], d[3];
  for (int k = 0; k < 3; k++) path[k] = Scalar((double(b.v[k]) - double(a.v[k])) * t), d[k] = apart[k] + path[k];
  for (std::uint32_t i = 0; i < m.count; i++) {
    ManifoldPoint<Scalar>& point = m.points[i];
    point.separation += Scalar(double(passing(a, b, m.normal, point.p, d).closing) * t);
    for (int k = 0; k < 3; k++) point.p[k] -= Scalar(double(path[k]) * share);
  }
}

/// How two shapes stand at a time of the sub-step, and the manifold there (left as it was where they are too far
/// apart for one).
template <class Scalar, class Find> struct Approach {
  Mover<Scalar> a, b;
  const Scalar* apart;
  Find& find;
  ShapeView<Scalar> here, there;

  void go_to(double t) {
    here = after(a, t);
    there = after(b, t);
    for (int i = 0; i < 3; i++) there.p[i] += apart[i] + Scalar((double(b.twist.v[i]) - double(a.twist.v[i])) * t);
  }
  bool look(double t, Manifold<Scalar>& m) {
    go_to(t);
    Manifold<Scalar> next;
    find(here, there, next);
    if (next.count == 0) return false;
    m = next;
    return true;
  }
  double gap(const Manifold<Scalar>& m) const {
    return std::min(double(support_gap(here, there, m.normal)), double(least_separation(m)));
  }
  /// How fast the gap along a normal closes, at most [m/s].
  double nearing(Vec3 n) const { return a.spin_along(n) + b.spin_along(n) + dot(n, a.velocity() - b.velocity()); }

  double gap_along(Vec3 n) const {
    const Scalar along[3] = {Scalar(n.x), Scalar(n.y), Scalar(n.z)};
    return double(support_gap(here, there, along));
  }
  /// The gap along n, times its length, s [s] after t, from below. The bound is concave in s: where it is open now and
  /// then it is open in between.
  double gap_within(const TurningNormal& n, double t, double s) const {
    const Vec3 speed = b.velocity() - a.velocity();
    const Vec3 centre = Vec3{double(apart[0]), double(apart[1]), double(apart[2])} + t * speed;
    double gap = dot(n.n, centre) + s * (dot(n.n, speed) + dot(n.rate, centre));
    gap += std::min(dot(n.rate, speed), 0.0) * s * s;
    if (a.view->kind != ShapeKind::plane) gap -= a.reach_within(here, {}, n, s);
    if (b.view->kind != ShapeKind::plane) gap -= b.reach_within(there, centre, {-n.n, -n.rate}, s);
    return gap;
  }
};

/// Goes on from t to where the shapes, `gap` [m] apart along a normal that turns, come within `near` [m] of each other
/// along it. Whether they do not until h [s]. Chords of a concave bound never go too far. The next one is twice as long
/// as this one says that the gap lasts, so that it bends little.
template <class Scalar, class Find>
bool stay_apart(Approach<Scalar, Find>& way, TurningNormal normal, double gap, double near, double h, double& t) {
  constexpr int chords = 8;
  double span = h - t;
  for (int i = 0; i < chords && gap > near; i++) {
    if (t >= h || way.nearing(normal.n) * (h - t) < gap - near) return true;
    span = std::min(span, h - t);
    double then = way.gap_within(normal, t, span);
    if (normal.rate != Vec3{} && then <= near * length(normal.at(span))) {
      const double still = way.gap_within({normal.n, {}}, t, span);  // where the look before saw another face
      if (still > then) {
        then = still;
        normal.rate = {};
      }
    }
    if (then > near * length(normal.at(span)) && span == h - t) return true;
    const double aim = near / 2, goes = then < aim ? span * (gap - aim) / (gap - then) : span;
    const double closing = (gap - then) / span;
    t = std::min(h, t + goes);
    normal.n = normal.at(goes);
    normal.n = (1 / length(normal.n)) * normal.n;
    way.go_to(t);
    gap = way.gap_along(normal.n);
    span = closing > 0 ? 2 * (gap - aim) / closing : h - t;
  }
  return false;
}

/// The instant from `from` to h [s] at which the shapes come within `near` [m] of each other, and the manifold there,
/// by conservative advancement. `m`: that of the start, where `from` is 0. As long as they are apart along a normal no
/// look for another is needed. From the second look on it goes on turning as it did since the one before.
/// Bounded: what is missed the next sub-step sees.
template <class Scalar, class Find>
std::optional<double> meet_within(const Mover<Scalar>& a, const Mover<Scalar>& b, const Scalar* apart, double near,
                                  double from, double h, Find&& find, Manifold<Scalar>& m) {
  constexpr int looks = 16;
  Approach<Scalar, std::remove_reference_t<Find>> way{a, b, apart, find, {}, {}};
  double t = from, seen = from;
  if (from > 0 && !way.look(t, m)) return {};
  if (from == 0) way.go_to(t);  // what is there is known
  Vec3 before;
  for (int k = 0; k < looks; k++) {
    const double gap = way.gap(m);
    if (gap <= near) return t;
    TurningNormal normal{{double(m.normal[0]), double(m.normal[1]), double(m.normal[2])}, {}};
    if (t > seen) normal.rate = (1 / (t - seen)) * (normal.n - before);
    before = normal.n;
    seen = t;
    if (stay_apart(way, normal, gap, near, h, t) || !way.look(t, m)) return {};
  }
  return {};
}

/// What lies within this share of a thickness of a surface lies in it: so high may a seam between tiles be, and so far
/// may shapes be apart whose contact lasts.
constexpr double seam_share = 2e-3;

/// Shapes are together within this: a millionth of their thickness, or what rounding leaves of where they stand, up to
/// a seam [m].
inline double near_of(double thick, double far, double epsilon) {
  return std::min(std::max(1e-6 * thick, 16 * epsilon * far), seam_share * thick);
}

}  // namespace pcphys
