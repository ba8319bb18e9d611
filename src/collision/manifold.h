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

}  // namespace pcphys
