#pragma once
#include <algorithm>
#include <cstdint>

#include "world/tables.h"

namespace pcphys {

/// From above, of a body's spin and of how much the last sub-step changed it, as if it turned about the axis of its
/// least moment: spares most bodies the turn into their frame. Squared [1/s^2].
template <class Scalar> class SpinBounds {
 public:
  explicit SpinBounds(const Tables& t)
      : momenta_(t.data<Scalar>(Buffer::motion) + 4),
        changes_(t.data<Scalar>(Buffer::velocity_parts) + 4),
        inverse_moments_(t.data<Scalar>(Buffer::mass) + 4) {}

  double spin(std::uint32_t row) const { return of(row, momentum(row) + half_change(row)); }
  double change(std::uint32_t row) const { return 4 * of(row, half_change(row)); }

 private:
  double of(std::uint32_t row, Vec3 momentum) const {
    const Vec3 inverse = at(inverse_moments_, Buffer::mass, row);
    const double largest = std::max({inverse.x, inverse.y, inverse.z});
    return largest * largest * dot(momentum, momentum);
  }
  Vec3 momentum(std::uint32_t row) const { return at(momenta_, Buffer::motion, row); }
  Vec3 half_change(std::uint32_t row) const { return at(changes_, Buffer::velocity_parts, row); }
  static Vec3 at(const Scalar* column, Buffer buffer, std::uint32_t row) {
    const Scalar* v = column + row * reals_of(buffer);
    return {double(v[0]), double(v[1]), double(v[2])};
  }
  const Scalar *momenta_, *changes_, *inverse_moments_;  // of row 0
};

}  // namespace pcphys
