// How far apart two shapes are along a direction: never more than their distance.
#pragma once
#include <cmath>

#include "collision/view.h"

namespace pcphys {

/// The reach of a shape along a unit direction n, from its centre [m]. Not of planes.
template <class Scalar> Scalar reach_along(const ShapeView<Scalar>& s, const Scalar* n) {
  const Scalar back[4] = {-s.q[0], -s.q[1], -s.q[2], s.q[3]};
  Scalar d[3];
  rotate_by(back, n, d);
  switch (s.kind) {
    case ShapeKind::sphere: return s.size[0];
    case ShapeKind::capsule: return s.size[0] + std::abs(d[1]) * s.size[1];
    case ShapeKind::box: return std::abs(d[0]) * s.size[0] + std::abs(d[1]) * s.size[1] + std::abs(d[2]) * s.size[2];
    case ShapeKind::cylinder: return std::sqrt(d[0] * d[0] + d[2] * d[2]) * s.size[0] + std::abs(d[1]) * s.size[1];
    default: break;
  }
  const Scalar* v = nullptr;
  s.hull->table.reals_of(v);
  const std::size_t reals = 3 * std::size_t(s.hull->table.indices[0]);
  Scalar most = 0;  // the centre is inside
  for (std::size_t i = 0; i < reals; i += 3) most = std::max(most, d[0] * v[i] + d[1] * v[i + 1] + d[2] * v[i + 2]);
  return most;
}

/// n: from a to b. Negative where they overlap along it.
template <class Scalar> Scalar support_gap(const ShapeView<Scalar>& a, const ShapeView<Scalar>& b, const Scalar* n) {
  const Scalar back[3] = {-n[0], -n[1], -n[2]};
  Scalar apart = 0;
  for (int k = 0; k < 3; k++) apart += n[k] * (b.p[k] - a.p[k]);
  const Scalar of_a = a.kind == ShapeKind::plane ? Scalar(0) : reach_along(a, n);
  const Scalar of_b = b.kind == ShapeKind::plane ? Scalar(0) : reach_along(b, back);
  return apart - of_a - of_b;
}

}  // namespace pcphys
