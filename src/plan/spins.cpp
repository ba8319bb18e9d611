#include "plan/spins.h"

#include <algorithm>

#include "pcphys/constants.h"
#include "plan/forest.h"

namespace pcphys {

void want_for_spins(const WorldState& state, const Forest& forest, double h, std::uint8_t highest_octave,
                    std::vector<Wanted>& wanted) {
  if (forest.trees() == 0) return;
  const double most = constants::largest_joint_turn / h;
  for (std::size_t i = 0; i < forest.trees(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    if (tree.front().flipped) continue;  // turns on a pivot
    for (const TreeNode& node : tree) {
      const std::uint32_t row = node.body;
      if (!state.responds(row)) continue;
      // no faster than the momentum about the axis of the least moment: spares most bodies the turn into their frame
      const Vec3 inverse = state.tables.get3(Buffer::mass, row, 4), momentum = state.momentum_of_rotation(row);
      const double largest = std::max({inverse.x, inverse.y, inverse.z});
      if (largest * largest * dot(momentum, momentum) <= most * most) continue;
      const Vec3 spin = state.angular_velocity(row);
      if (const std::uint8_t octave = octave_for(dot(spin, spin), most * most, highest_octave); octave > 0)
        wanted.push_back({row, octave, false});
    }
  }
}

}  // namespace pcphys
