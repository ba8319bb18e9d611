// A shape on its way through a sub-step, and how far it reaches along a normal that turns.
#pragma once
#include <algorithm>
#include <cmath>

#include "collision/support_gap.h"
#include "collision/twist.h"
#include "collision/view.h"

namespace pcphys {

/// A unit vector that turns: s [s] from now n + s rate, up to its length.
struct TurningNormal {
  Vec3 n, rate;

  Vec3 at(double s) const { return n + s * rate; }
};

/// A shape on its way: view as at the start of the step, p relative to its body's centre.
template <class Scalar> struct Mover {
  const ShapeView<Scalar>* view;
  TwistOf<Scalar> twist;
  float spin;    // how fast its surface comes outward by turning, at most [m/s]
  bool centred;  // its frame is the body's
  float lever;   // how far a turn of one radian moves its surface outward, at most [m]

  Vec3 velocity() const { return {double(twist.v[0]), double(twist.v[1]), double(twist.v[2])}; }
  Vec3 angular_velocity() const { return {double(twist.w[0]), double(twist.w[1]), double(twist.w[2])}; }

  /// How fast it comes along the unit vector n by turning, at most [m/s]: n . (w x r) = r . (n x w).
  double spin_along(Vec3 n) const {
    return std::min(double(spin), length(cross(n, angular_velocity())) * double(lever));
  }

  /// How far it reaches along `to` within s [s] from now, at most, from its body's centre, which now is at `centre` in
  /// the coordinates of `now`. A shape that turns reaches as far along n as it does now along R^T n =
  /// n + s (rate + n x w) + O(s^2). What is of first order is convex in s, as all supports are; what is of second is
  /// bounded by half of the second derivative, R^T ((n x w) x w + 2 rate x w), by the arm or by its speed.
  double reach_within(const ShapeView<Scalar>& now, Vec3 centre, const TurningNormal& to, double s) const {
    const Vec3 w = angular_velocity(), back = cross(to.n, w), d = to.n + s * (to.rate + back);
    const double fast = double(twist.turn), turns = length(to.rate), later = fast * turns * s / 2;
    const double bend = std::min(double(lever) * (length(0.5 * cross(back, w) + cross(to.rate, w)) + fast * later),
                                 double(spin) * (fast / 2 + turns + later));
    const Scalar along[3] = {Scalar(d.x), Scalar(d.y), Scalar(d.z)};
    const bool round = now.kind == ShapeKind::sphere || now.kind == ShapeKind::capsule;
    const double rounding = round ? double(now.size[0]) * (length(to.at(s)) - 1) : 0;
    const Vec3 arm = Vec3{double(now.p[0]), double(now.p[1]), double(now.p[2])} - centre;
    return dot(d, arm) + double(reach_along(now, along)) + rounding + bend * s * s;
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

}  // namespace pcphys
