// What the narrow phase finds. Includes nothing: the files of lanes read it too.
#pragma once
#include <cstdint>

namespace pcphys {

template <class Scalar> struct ManifoldPoint {
  Scalar p[3];            // midway between the surfaces
  Scalar separation;      // along the normal, negative when the shapes overlap
  std::uint32_t feature;  // which corner, edge or side: the same from step to step while the shapes move a little
};

template <class Scalar> struct Manifold {
  Scalar normal[3];  // unit, from a to b
  std::uint32_t count = 0;
  ManifoldPoint<Scalar> points[4];
};

/// Shapes may be so far from each other that numbers tell none.
template <class Scalar> bool has_normal(const Manifold<Scalar>& m) {
  const Scalar* n = m.normal;
  return m.count > 0 && n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > Scalar(0.5);
}

}  // namespace pcphys
