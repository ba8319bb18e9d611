// Pairs of shapes that move fast for their size, as the detector looks at them before the others.
#pragma once
#include <algorithm>
#include <cstdint>

#include "collision/narrow.h"
#include "world/tables.h"

namespace pcphys {

/// A pair as the narrow phase is to see it: from the first body's centre.
template <class Scalar> struct Sight {
  std::uint32_t shapes[2], rows[2];  // in the order of the contact's bodies
  Scalar apart[3];                   // the second body's centre
  ShapeView<Scalar> there;           // the second shape
  Scalar margin;                     // no gap beyond it matters in this step
};

/// Of the way that two bodies come together, the part that the second does not go: by their inverse masses.
template <class Scalar> double share_of(const Tables& t, std::uint32_t a, std::uint32_t b) {
  const Scalar* inverse_masses = t.data<Scalar>(Buffer::motion) + 3;
  const double wa = double(inverse_masses[a * reals_of(Buffer::motion)]),
               wb = double(inverse_masses[b * reals_of(Buffer::motion)]);
  return wb / (wa + wb);
}

/// Bodies meet across a gap nearer to the heavy one, and nowhere but at the surface of one that stands: `pc_arms` draws
/// the arms together by the same shares. In an overlap, too, the point is on the light body's own surface, so that a
/// ball that has sunk into a floor rolls on its whole radius.
template <class Scalar> void to_light_side(Manifold<Scalar>& m, double share) {
  for (std::uint32_t i = 0; i < m.count; i++) {
    const Scalar shift = m.points[i].separation * Scalar(share - 0.5);
    for (int k = 0; k < 3; k++) m.points[i].p[k] += m.normal[k] * shift;
  }
}

}  // namespace pcphys
