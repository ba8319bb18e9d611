// How a body moves, and how two pass each other. For bounds float in both precisions, since nothing but which contacts
// are listed comes of them; the way to a meeting in flight is in the world's own.
#pragma once
#include <cmath>

namespace pcphys {

/// Beyond the first, turning closes no gap that is larger than the body: spins of everyday scenes keep their contacts'
/// bits [rad]. Beyond the second a turning surface comes no further outward [rad].
inline constexpr float wild_turn = 100, largest_turn = 2;

template <class Real> struct TwistOf {
  // velocity of the centre [m/s], angular velocity [rad/s], world axes;
  // |v|, |w|, and the part of w across the body's y axis
  Real v[3] = {}, speed = 0, w[3] = {}, turn = 0, across = 0;
  Real unused[3] = {};  // three quads: narrow_lanes.h fills them

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
static_assert(sizeof(Twist) == 12 * sizeof(float) && sizeof(TwistOf<double>) == 12 * sizeof(double));

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
