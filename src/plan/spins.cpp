#include "plan/spins.h"

#include <algorithm>

#include "pcphys/constants.h"
#include "plan/forest.h"

namespace pcphys {

namespace {

/// No faster than the momentum about the axis of the least moment: spares most bodies the turn into their frame [1/s].
template <class Scalar> class SpinBound {
 public:
  explicit SpinBound(const Tables& t)
      : momenta_(t.data<Scalar>(Buffer::motion) + 4),
        changes_(t.data<Scalar>(Buffer::velocity_parts) + 4),
        inverse_moments_(t.data<Scalar>(Buffer::mass) + 4) {}

  double squared(std::uint32_t row) const {
    const Vec3 momentum = at(momenta_, Buffer::motion, row) + at(changes_, Buffer::velocity_parts, row);
    const Vec3 inverse = at(inverse_moments_, Buffer::mass, row);
    const double largest = std::max({inverse.x, inverse.y, inverse.z});
    return largest * largest * dot(momentum, momentum);
  }

 private:
  static Vec3 at(const Scalar* column, Buffer buffer, std::uint32_t row) {
    const Scalar* v = column + row * reals_of(buffer);
    return {double(v[0]), double(v[1]), double(v[2])};
  }
  const Scalar *momenta_, *changes_, *inverse_moments_;  // of row 0
};

template <class Scalar>
void want(const WorldState& state, const Forest& forest, double most, std::uint8_t highest_octave, std::vector<Wanted>& wanted) {
  const SpinBound<Scalar> bound(state.tables);
  for (std::size_t i = 0; i < forest.trees(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    if (tree.front().flipped) continue;  // turns on a pivot
    for (const TreeNode& node : tree) {
      const std::uint32_t row = node.body;
      if (bound.squared(row) <= most * most || !state.responds(row)) continue;
      const Vec3 spin = state.angular_velocity(row);
      if (const std::uint8_t octave = octave_for(dot(spin, spin), most * most, highest_octave); octave > 0)
        wanted.push_back({row, octave, false});
    }
  }
}

}  // namespace

void want_for_spins(const WorldState& state, const Forest& forest, double h, std::uint8_t highest_octave,
                    std::vector<Wanted>& wanted) {
  if (forest.trees() == 0) return;
  const double most = constants::largest_joint_turn / h;
  state.tables.precision() == Precision::f32 ? want<float>(state, forest, most, highest_octave, wanted)
                                             : want<double>(state, forest, most, highest_octave, wanted);
}

}  // namespace pcphys
