// When and how two shapes meet that move fast for their size: conservative advancement (B. Mirtich, 1996). The manifold
// of that instant stands in for the one at the step's start, whose normal would turn before they touch.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "collision/narrow.h"
#include "collision/support_gap.h"
#include "collision/twist.h"
#include "collision/view.h"

namespace pcphys {

/// A shape on its way: view as at the start of the step, p relative to its body's centre.
template <class Scalar> struct Mover {
  const ShapeView<Scalar>* view;
  TwistOf<Scalar> twist;
  float spin;    // how fast its surface comes outward by turning, at most [m/s]
  bool centred;  // its frame is the body's
  float lever;   // how far a turn of one radian moves its surface outward, at most [m]
  float core;    // of a sphere about its centre that lies inside of it; 0: none is known [m]

  /// How fast it comes along the unit vector n by turning, at most [m/s]: n . (w x r) = r . (n x w).
  double spin_along(const Scalar* n) const {
    double squared = 0;
    for (int k = 0; k < 3; k++) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const double c = double(n[i]) * double(twist.w[j]) - double(n[j]) * double(twist.w[i]);
      squared += c * c;
    }
    return std::min(double(spin), std::sqrt(squared) * double(lever));
  }
};

/// q turned by the rotation vector w t. Eight turns whose half angle's tangent is taken for the angle: within 1 % of a
/// turn of 2 rad, and no library function in it.
template <class Scalar> void turn_by(const Scalar* w, double t, Scalar* q) {
  double d[4] = {double(w[0]) * t / 16, double(w[1]) * t / 16, double(w[2]) * t / 16, 1};
  const double l = 1 / std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + 1);
  for (double& x : d) x *= l;
  for (int k = 0; k < 3; k++) {  // squared: v 2 w, w w - v v
    const double vv = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], ww = d[3];
    for (int i = 0; i < 3; i++) d[i] *= 2 * ww;
    d[3] = ww * ww - vv;
  }
  const double x = double(q[0]), y = double(q[1]), z = double(q[2]), s = double(q[3]);
  q[0] = Scalar(d[3] * x + d[0] * s + d[1] * z - d[2] * y);
  q[1] = Scalar(d[3] * y - d[0] * z + d[1] * s + d[2] * x);
  q[2] = Scalar(d[3] * z + d[0] * y - d[1] * x + d[2] * s);
  q[3] = Scalar(d[3] * s - d[0] * x - d[1] * y - d[2] * z);
}

template <class Scalar> ShapeView<Scalar> after(const Mover<Scalar>& m, double t) {
  ShapeView<Scalar> view = *m.view;
  if (m.twist.turn == 0 || (m.centred && view.kind == ShapeKind::sphere)) return view;
  turn_by(m.twist.w, t, view.q);
  if (m.centred) return view;
  Scalar turn[4] = {0, 0, 0, 1}, p[3] = {view.p[0], view.p[1], view.p[2]};
  turn_by(m.twist.w, t, turn);
  rotate_by(turn, p, view.p);
  return view;
}

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
  double nearing(const Scalar* n) const {
    double rate = a.spin_along(n) + b.spin_along(n);
    for (int i = 0; i < 3; i++) rate += double(n[i]) * (double(a.twist.v[i]) - double(b.twist.v[i]));
    return rate;
  }
};

enum class Advanced { apart, together, creeps };

/// When a manifold was found [s], and whether the shapes come together then.
struct Met {
  bool together;
  double t;
};

/// Conservative advancement from t on to the instant within h [s] at which the shapes come within `near` [m] of each
/// other, with the manifold there; else that of `seen`, when they were looked at last. As long as they are apart along
/// the normal that was found last they need no look for another.
/// Bounded: it creeps where shapes turn fast for how they come together.
template <class Scalar, class Find>
Advanced advance(Approach<Scalar, Find>& way, double near, double h, double& t, Manifold<Scalar>& m, double& seen) {
  constexpr int looks = 16, along = 8;
  for (int k = 0; k < looks; k++) {
    double gap = way.gap(m);
    if (gap <= near) return Advanced::together;
    for (int i = 0; i < along && gap > near; i++) {
      if (t >= h) return Advanced::apart;
      const double nearing = way.nearing(m.normal);
      if (nearing * (h - t) < gap - near) return Advanced::apart;
      t = std::min(h, t + (gap - near / 2) / nearing);
      way.go_to(t);
      gap = double(support_gap(way.here, way.there, m.normal));
    }
    if (!way.look(t, m)) return Advanced::apart;
    seen = t;
  }
  return Advanced::creeps;
}

/// When the spheres inside two shapes meet, by when the shapes have; below 0 where they do not.
/// Turning does not move them.
template <class Scalar, class Find>
double cores_meet(const Approach<Scalar, Find>& of, double t, double near, double h) {
  ShapeView<Scalar> cores[2] = {*of.a.view, *of.b.view};
  Mover<Scalar> movers[2] = {of.a, of.b};
  for (int side = 0; side < 2; side++) {
    if (movers[side].core <= 0 || !movers[side].centred) continue;
    cores[side].kind = ShapeKind::sphere;
    cores[side].size[0] = Scalar(movers[side].core);
    movers[side].view = &cores[side];
    movers[side].spin = movers[side].lever = 0;
  }
  Approach<Scalar, Find> way{movers[0], movers[1], of.apart, of.find, {}, {}};
  Manifold<Scalar> m;
  if (!way.look(t, m)) return -1;
  double seen = t;
  return advance(way, near, h, t, m, seen) == Advanced::together ? t : -1;
}

/// The instant from `from` to h [s] at which the shapes come within `near` [m] of each other, and the manifold there;
/// or that of when they were looked at last on ways on which they do not. Where advancement creeps, halving finds an
/// instant before they overlap at the end, or before what is inside of them meets.
/// What is missed all the same the next sub-step sees.
template <class Scalar, class Find>
Met meet_within(const Mover<Scalar>& a, const Mover<Scalar>& b, const Scalar* apart, double near, double from, double h,
                Find&& find, Manifold<Scalar>& m) {
  constexpr int halvings = 20;
  Approach<Scalar, std::remove_reference_t<Find>> way{a, b, apart, find, {}, {}};
  double t = from, seen = from;
  if (from > 0 && !way.look(t, m)) return {false, seen};
  if (from == 0) way.go_to(t);  // what is there is known
  const Advanced advanced = advance(way, near, h, t, m, seen);
  if (advanced == Advanced::together) return {true, t};
  if (advanced == Advanced::apart) return {false, seen};
  double late = cores_meet(way, t, near, h);
  if (late < 0) late = h;
  Manifold<Scalar> end = m;
  if (!way.look(late, end) || way.gap(end) > near) return {false, seen};
  for (int k = 0; k < halvings; k++) {
    const double middle = t + (late - t) / 2;
    Manifold<Scalar> there = m;
    const bool together = way.look(middle, there) && way.gap(there) <= near;
    (together ? late : t) = middle;
    if (!together) m = there;
  }
  return {true, t};
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
