// The joint trees that parity is checked on, and how their nodes lie in memory. The logical order of nodes is that of
// one lane: trees of one shape one after the other, nodes of a tree one after the other.
#pragma once
#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "plan/forest.h"

namespace parity {
using namespace pcphys;

/// Of each node but the first its parent; `hangs`: the first is a fixed or kinematic body.
struct TreeShape {
  std::uint32_t trees;
  bool hangs;
  std::vector<std::uint32_t> parents;
};
/// Levels of 3, 9, 27 and 40 nodes.
inline std::vector<std::uint32_t> wide_tree() {
  std::vector<std::uint32_t> parents;
  for (std::uint32_t k = 1; k < 40; k++) parents.push_back((k - 1) / 3);
  for (std::uint32_t k = 0; k < 40; k++) parents.push_back(13 + k * k % 27);
  std::ranges::sort(parents);  // breadth first
  return parents;
}
/// More trees than 32 lanes, fewer than 4, and numbers between, so that some lanes of each width are padding.
inline const std::vector<TreeShape>& tree_shapes() {
  static const std::vector<TreeShape> shapes = {
      {40, false, {0}},
      {35, true, {0, 1, 2}},
      {20, false, {0, 0, 0}},
      {9, false, {0, 0, 1, 1, 3}},
      {6, true, {0, 1, 1, 2, 0}},
      {37, true, {0}},
      {1, true, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}},
      // for work groups: more nodes in a level than invocations, with brothers and without; a chain below a bush; many
      // children of one body
      {1, false, wide_tree()},
      {1, true, {0, 1, 1, 1, 2, 2, 3, 4, 5, 5, 9, 11, 12, 13}},
      {1, false, std::vector<std::uint32_t>(200, 0)},
  };
  return shapes;
}
inline std::uint32_t tree_joints() {
  std::uint32_t count = 0;
  for (const TreeShape& shape : tree_shapes()) count += shape.trees * std::uint32_t(shape.parents.size());
  return count;
}

inline std::uint32_t tree_bodies() {
  std::uint32_t count = tree_joints();
  for (const TreeShape& shape : tree_shapes()) count += shape.hangs ? 0 : shape.trees;
  return count;
}

/// Joints of rows `first_joint` on, between bodies from `body` on in turn; what hangs does so from one of `anchors`.
inline std::vector<JointLink> tree_links(std::uint32_t first_joint, std::uint32_t body,
                                         const std::vector<std::uint32_t>& anchors, std::mt19937_64& random) {
  std::vector<JointLink> links;
  for (const TreeShape& shape : tree_shapes())
    for (std::uint32_t tree = 0; tree < shape.trees; tree++) {
      std::vector<std::uint32_t> nodes{shape.hangs ? anchors[random() % anchors.size()] : body++};
      const bool is_long = shape.parents.size() > 3;
      for (const std::uint32_t parent : shape.parents) {
        // whether a or b is the child is part of a shape: trees of one shape must stay alike to share a block
        const bool flipped = is_long ? nodes.size() % 2 == 0 : tree % 8 == 7;
        const std::uint32_t row = first_joint + std::uint32_t(links.size()), above = nodes[parent];
        // one that is fixed has one joint only: a second one would begin another tree
        const std::uint32_t from = shape.hangs && parent == 0 && nodes.size() > 1 ? nodes[1] : above;
        nodes.push_back(body++);
        links.push_back({row, flipped ? nodes.back() : from, flipped ? from : nodes.back(), row});
      }
    }
  return links;
}

/// A forest laid out for a width, and where each node stands there.
struct TreeLayout {
  TreeBlocks lists;
  std::vector<std::uint32_t> slots;  // of nodes in logical order
  std::size_t size = 0;              // slots, with the padding
};
inline TreeLayout lay_out(const Forest& forest, std::uint32_t width) {
  TreeLayout layout;
  TreeBlocks& lists = layout.lists;
  TreeShapes shapes;
  shapes.build(forest);
  pack_trees(forest, shapes, width, lists);
  layout.size = lists.parents.size() * width;
  for (std::uint32_t block = 0; block < lists.count(); block++) {
    const std::uint32_t first = lists.blocks[3 * block], count = lists.blocks[3 * block + 1];
    for (std::uint32_t lane = 0; lane < width; lane++) {
      const bool padding = lists.ends[((first + 1) * 2 + 1) * width + lane] == 0;  // the first child has no joint
      for (std::uint32_t k = 0; k < count && !padding; k++) layout.slots.push_back((first + k) * width + lane);
    }
  }
  return layout;
}

}  // namespace parity
