// Joint trees: a spanning forest of the joint graph. Each tree is solved directly (docs/joints.md); joints that close a
// loop, or tie a tree to a second fixed body, are left over for rows.
//
// A joint to a fixed or kinematic body begins a tree with that body as its root, unless a lower one holds the same body
// already; all of them grow at once, so that a net or a bridge hangs from each of its anchors by the shortest way. A
// tree without such a joint has its heaviest body as its root. Breadth first, joints in the order of their ids: trees
// that were made alike come out alike.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "plan/octave_of.h"
#include "step/backend.h"
#include "world/memory.h"

namespace pcphys {

/// A joint as the forest sees it: body rows, and its id for the order. Those that yield (JointDef::largest_force) stand
/// in no tree.
struct JointLink {
  std::uint32_t row, a, b, id;
  bool yields = false;
};

struct TreeNode {
  std::uint32_t body, joint;  // rows; of the root the joint is 0
  // position in the tree, before this node's; of the root 1 where some joint closes a loop with its tree
  std::uint32_t parent;
  bool flipped;  // the joint's body a is the child; of a root: set_pivot
};

class Forest {
 public:
  /// `links` in any order; `masses` and `ids` by body row, mass 0 for bodies that nothing moves.
  void build(std::span<const JointLink> links, std::span<const double> masses, std::span<const std::uint32_t> ids);

  std::size_t trees() const { return first_.empty() ? 0 : first_.size() - 1; }
  /// Place of a tree's first node among all nodes.
  std::uint32_t first(std::size_t i) const { return first_[i]; }
  /// Parents before children; the first is the root.
  std::span<const TreeNode> tree(std::size_t i) const {
    return std::span(nodes_).subspan(first_[i], first_[i + 1] - first_[i]);
  }
  /// Marks a tree's root: its one other body turns about their joint.
  void set_pivot(std::size_t tree) { nodes_[first_[tree]].flipped = true; }
  /// Whether a joint that stands in no tree holds a body of this one: its root's mark in `parent`.
  bool has_loop(std::size_t tree) const { return nodes_[first_[tree]].parent == 1; }
  /// Rows of the joints that stand in no tree, ascending.
  std::span<const std::uint32_t> closing() const { return closing_; }
  std::size_t memory_bytes() const {
    return bytes_of(links_, begin_, links_of_, reached_, used_, masses_, trees_, nodes_, first_, closing_);
  }

 private:
  /// All trees that hang on something fixed.
  void grow_hanging();
  /// Those in `trees_`, level by level and all at once: each body goes to the root that is nearest.
  void grow();

  std::vector<JointLink> links_;                 // by id
  std::vector<std::uint32_t> begin_, links_of_;  // of each body row, its links by id
  std::vector<char> reached_, used_;             // by body row; by link
  std::vector<double> masses_;
  std::vector<std::vector<TreeNode>> trees_;  // that grow
  std::vector<TreeNode> nodes_;
  std::vector<std::uint32_t> first_, closing_;
};

/// The forest laid out for `width` lanes: trees of one shape share blocks, one tree a lane; what is left over of a
/// block is padding (rows 0).
///
/// Levels are there where a block is one tree, for a work group that shares it (glcompute/team.glsl): the number of
/// spans of nodes; of each, and of what follows the last, its first node, and its first group << 1 | whether it is a
/// chain; then of each group, and of what follows the last, its first node. The root is a span, each level below it is
/// another, and levels of one node in a row are one, a chain. Groups: nodes of one parent.
struct TreeBlocks {
  // of each block its first node, their number, and where its levels begin; then levels
  std::vector<std::uint32_t> blocks;
  std::vector<std::uint32_t> parents;  // of each node parent << 1 | flipped
  std::vector<std::uint32_t> ends;     // ends[(node * 2 + side) * width + lane]: body row, joint row
  std::vector<std::uint32_t> order;    // order[node * width + lane]: 1 + the node's place in the forest; 0 pads
  std::vector<Range> ranges;           // blocks of each octave
  std::size_t memory_bytes() const { return bytes_of(blocks, parents, ends, order, ranges); }

  std::uint32_t count() const { return ranges.empty() ? 0 : ranges.back().end; }
};

/// Whether some joint of the tree holds an angle.
bool has_limits(const WorldState& state, std::span<const TreeNode> tree);

/// Which trees of a forest have one shape: one topology, and joints the same way round.
class TreeShapes {
 public:
  void build(const Forest& forest);
  std::size_t count() const { return begin_.size() - 1; }
  /// Trees of a shape, in the order of the forest.
  std::span<const std::uint32_t> trees(std::size_t shape) const {
    return std::span(trees_).subspan(begin_[shape], begin_[shape + 1] - begin_[shape]);
  }
  /// How many there are of the shape of which there are most.
  std::uint32_t most_alike() const;
  std::size_t memory_bytes() const { return bytes_of(trees_, begin_); }

 private:
  std::vector<std::uint32_t> trees_, begin_{0};
};

/// `of`: by tree.
void pack_trees(const Forest& forest, const TreeShapes& shapes, std::uint32_t width, TreeBlocks& out, OctaveOf of = {});

}  // namespace pcphys
