// When and how two shapes meet that move fast for their size: conservative advancement (B. Mirtich, 1996). The manifold
// of that instant stands in for the one at the step's start, whose normal would turn before they touch.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "collision/narrow.h"
#include "collision/twist.h"
#include "collision/view.h"

namespace pcphys {

/// A shape on its way: view as at the start of the step, p relative to its body's centre.
template <class Scalar> struct Mover {
  const ShapeView<Scalar>* view;
  TwistOf<Scalar> twist;
  float spin;    // how fast its surface comes outward by turning, at most [m/s]
  bool centred;  // its frame is the body's
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

inline constexpr double later = -1, past = -2;

/// From the manifold at the start, to that of the instant at which the shapes come within `near` [m] of each other, which
/// is returned [s]; or the one at the end of the step if they come within `margin` by then; or `later`: nothing brings them
/// together within the step as they move now; or `past`: they pass each other by.
/// `apart`: b's centre as seen from a's. `find(a, b, manifold)`: the narrow phase, with a margin that all gaps are within.
template <class Scalar, class Find>
double meet(const Mover<Scalar>& a, const Mover<Scalar>& b, const Scalar* apart, double near, double margin, double dt,
            Find&& find, Manifold<Scalar>& m) {
  constexpr int most = 32;
  double t = 0;
  for (int k = 0; k < most; k++) {
    const double gap = double(least_separation(m));
    if (gap <= near || (t == dt && gap <= margin)) return t;
    double nearing = double(a.spin) + double(b.spin);
    for (int i = 0; i < 3; i++) nearing += double(m.normal[i]) * (double(a.twist.v[i]) - double(b.twist.v[i]));
    if (t == dt || (t == 0 && nearing <= 0)) return later;
    if (nearing <= 0) return past;
    t = std::min(dt, t + (gap - near / 2) / nearing);
    ShapeView<Scalar> there = after(b, t);
    for (int i = 0; i < 3; i++) there.p[i] += apart[i] + Scalar((double(b.twist.v[i]) - double(a.twist.v[i])) * t);
    Manifold<Scalar> next;
    find(after(a, t), there, next);
    if (next.count == 0) return past;
    m = next;
  }
  return t;  // as near as that many looks have brought them; the rest closes as it would have from the start
}

}  // namespace pcphys
