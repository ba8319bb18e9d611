// Narrow phase on the CPU: where two shapes touch. The geometry stands in kernels/narrow; docs/narrow-phase.md
// says how each pair is done.
#pragma once
#include <cstdint>

#include "collision/manifold.h"
#include "pcphys/types.h"

namespace pcphys {

/// A shape relative to an origin nearby: best the centre of mass of the smaller body, since the digits of
/// the result are those of these numbers.
template <class Scalar> struct ShapeView {
  ShapeKind kind;
  Scalar size[3];  // as in ShapeDef, metres; a hull's radius and inner radius
  Scalar p[3];     // centre of the shape
  Scalar q[4];     // x y z w, shape to world axes, unit
  const HullData* hull = nullptr;
};

/// Points whose separation is at most `margin` [m]; none when the shapes are farther apart (then the normal means
/// nothing). `hint` is 0 at first and then what the last call for this pair left there;
/// it saves time and changes nothing else.
void narrow(const ShapeView<float>& a, const ShapeView<float>& b, float margin, std::uint32_t& hint,
            Manifold<float>& out);
void narrow(const ShapeView<double>& a, const ShapeView<double>& b, double margin, std::uint32_t& hint,
            Manifold<double>& out);

}  // namespace pcphys
