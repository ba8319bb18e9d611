// Balls on joints whose graph is a given tree: what benchmarks and tests build many unlike trees from.
#pragma once
#include <cstdint>
#include <vector>

#include "pcphys/world.h"
#include "random.h"

namespace pcphys::scenes {

/// Of each body but the first the one that it hangs on, which comes before it.
using Parents = std::vector<std::uint32_t>;

/// Of `bodies` bodies, each on one of the last two thirds of those before it.
Parents drawn_tree(std::uint32_t bodies, Random& random);
Parents chain_tree(std::uint32_t bodies);
Parents star_tree(std::uint32_t bodies);

struct TreeOfBalls {
  Vec3 place;              // of the first
  Vec3 spin{1, 2, 0.5};    // of each, in turn about and against it
  bool hangs = false;      // the first is pinned to the ground where it stands
  bool touches = false;    // meets what is not of the tree
  std::int32_t group = 1;  // of its balls, other than any other tree's
};
/// Balls of 0.1 m at 0.3 m from each other in drawn directions. Errors: those of World::create_body and create_joint.
Result<std::vector<BodyId>> add_balls(World& world, const Parents& parents, const TreeOfBalls& tree, Random& random);
/// A pin between two balls where they are, at the middle. Errors: those of World::create_joint.
Status pin_balls(World& world, BodyId a, BodyId b);

}  // namespace pcphys::scenes
