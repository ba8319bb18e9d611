// How a body moves. For bounds float in both precisions, since nothing but which contacts are listed comes of them; the way
// to a meeting in flight is in the world's own.
#pragma once
#include <cmath>
#include <cstdint>

#include "world/tables.h"

namespace pcphys {

/// Beyond the first, turning closes no gap that is larger than the body: spins of everyday scenes keep their contacts' bits
/// [rad]. Beyond the second a turning surface comes no further outward [rad].
inline constexpr float wild_turn = 100, largest_turn = 2;

template <class Real> struct TwistOf {
  Real v[3] = {}, w[3] = {};             // velocity of the centre [m/s], angular velocity [rad/s], world axes
  Real speed = 0, turn = 0, across = 0;  // |v|, |w|, and the part of w across the body's y axis

  /// A surface that turns by more within the step comes no nearer to anything.
  void limit_turn(double dt) {
    const Real step = Real(dt);
    if (!(turn * step > Real(wild_turn))) return;
    const Real share = Real(largest_turn) / step / turn;
    for (Real& x : w) x *= share;
    turn *= share;
    across *= share;
  }
};
using Twist = TwistOf<float>;

template <class Scalar, class Real = float> TwistOf<Real> twist_of(const Tables& t, std::uint32_t row) {
  const auto at = [&](Buffer buffer) { return t.data<Scalar>(buffer) + row * reals_of(buffer); };
  const Scalar *m = at(Buffer::motion), *i = at(Buffer::mass) + 4, *q = at(Buffer::pose) + 4;
  const Real x = Real(q[0]), y = Real(q[1]), z = Real(q[2]), w = Real(q[3]);
  const Real r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                     2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  const Real l[3] = {Real(m[4]), Real(m[5]), Real(m[6])};
  Real local[3];
  for (int k = 0; k < 3; k++) local[k] = Real(i[k]) * (r[k] * l[0] + r[3 + k] * l[1] + r[6 + k] * l[2]);
  TwistOf<Real> out;
  for (int k = 0; k < 3; k++) {
    out.v[k] = Real(m[k]);
    out.w[k] = r[3 * k] * local[0] + r[3 * k + 1] * local[1] + r[3 * k + 2] * local[2];
  }
  out.speed = std::sqrt(out.v[0] * out.v[0] + out.v[1] * out.v[1] + out.v[2] * out.v[2]);
  out.across = std::sqrt(local[0] * local[0] + local[2] * local[2]);
  out.turn = std::sqrt(local[0] * local[0] + local[1] * local[1] + local[2] * local[2]);
  return out;
}

/// How two bodies pass each other at a point.
template <class Real> struct Passing {
  Real closing = 0;  // rate at which the gap along the normal closes [m/s]
  Real sliding = 0;  // speed across the normal [m/s]
};

/// n: from a to b; r: the point as seen from a's centre, which stands `d` from b's.
template <class Real>
Passing<Real> passing(const TwistOf<Real>& a, const TwistOf<Real>& b, const Real* n, const Real* r, const Real* d) {
  Real v[3], squared = 0;
  Passing<Real> p;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    v[k] = a.v[k] + a.w[i] * r[j] - a.w[j] * r[i] - (b.v[k] + b.w[i] * (r[j] - d[j]) - b.w[j] * (r[i] - d[i]));
    p.closing += n[k] * v[k];
    squared += v[k] * v[k];
  }
  const Real across = squared - p.closing * p.closing;
  p.sliding = across > 0 ? std::sqrt(across) : 0;
  return p;
}

}  // namespace pcphys
