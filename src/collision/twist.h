// How a body moves, for bounds: float in both precisions, since nothing but which contacts are listed comes of it.
#pragma once
#include <cmath>
#include <cstdint>

#include "world/tables.h"

namespace pcphys {

struct Twist {
  float v[3] = {}, w[3] = {};             // velocity of the centre [m/s], angular velocity [rad/s], world axes
  float speed = 0, turn = 0, across = 0;  // |v|, |w|, and the part of w across the body's y axis

  /// A surface that turns faster comes no nearer to anything.
  void limit_turn(float largest) {
    if (!(turn > largest)) return;
    const float share = largest / turn;
    for (float& x : w) x *= share;
    turn *= share;
    across *= share;
  }
};

template <class Scalar> Twist twist_of(const Tables& t, std::uint32_t row) {
  const auto at = [&](Buffer buffer) { return t.data<Scalar>(buffer) + row * reals_of(buffer); };
  const Scalar *m = at(Buffer::motion), *i = at(Buffer::mass) + 4, *q = at(Buffer::pose) + 4;
  const float x = float(q[0]), y = float(q[1]), z = float(q[2]), w = float(q[3]);
  const float r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                      2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                      2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  const float l[3] = {float(m[4]), float(m[5]), float(m[6])};
  float local[3];
  for (int k = 0; k < 3; k++) local[k] = float(i[k]) * (r[k] * l[0] + r[3 + k] * l[1] + r[6 + k] * l[2]);
  Twist out;
  for (int k = 0; k < 3; k++) {
    out.v[k] = float(m[k]);
    out.w[k] = r[3 * k] * local[0] + r[3 * k + 1] * local[1] + r[3 * k + 2] * local[2];
  }
  out.speed = std::sqrt(out.v[0] * out.v[0] + out.v[1] * out.v[1] + out.v[2] * out.v[2]);
  out.across = std::sqrt(local[0] * local[0] + local[2] * local[2]);
  out.turn = std::sqrt(local[0] * local[0] + local[1] * local[1] + local[2] * local[2]);
  return out;
}

/// How two bodies pass each other at a point.
struct Passing {
  float closing = 0;  // rate at which the gap along the normal closes [m/s]
  float sliding = 0;  // speed across the normal [m/s]
};

/// n: from a to b; r: the point as seen from a's centre, which stands `d` from b's.
inline Passing passing(const Twist& a, const Twist& b, const float* n, const float* r, const float* d) {
  float v[3], squared = 0;
  Passing p;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    v[k] = a.v[k] + a.w[i] * r[j] - a.w[j] * r[i] - (b.v[k] + b.w[i] * (r[j] - d[j]) - b.w[j] * (r[i] - d[i]));
    p.closing += n[k] * v[k];
    squared += v[k] * v[k];
  }
  const float across = squared - p.closing * p.closing;
  p.sliding = across > 0 ? std::sqrt(across) : 0;
  return p;
}

}  // namespace pcphys
