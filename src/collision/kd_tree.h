// A midpoint KD-tree over boxes, built as a binary radix tree over Morton codes (T. Karras, Maximizing
// Parallelism in the Construction of BVHs, Octrees, and k-d Trees, HPG 2012): with the bits of the three
// axes interleaved, each level halves a cell along the next axis, and levels with nothing on one side are
// left out. Nodes carry tight boxes. Equal codes are split by the bits of their position in the order.
// Subtrees of up to four objects are not divided further: they are one block of boxes.
//
// The tree is a function of boxes and index order alone, on any executor. What it answers (queries, pairs)
// is a set that does not depend on the tree at all; only the time does.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/aabb.h"
#include "collision/box_block.h"

namespace pcphys {

class KdTree {
 public:
  /// Levels below the root at most: 63 code bits and 32 index bits, each of which splits a path only once.
  static constexpr std::uint32_t max_depth = 95;

  /// What `pairs` looks for: a pair is reported unless both objects are `still` (it is known already) or
  /// neither is `mobile`. Inner nodes carry the union of what is below, so whole subtrees are skipped.
  enum Flag : std::uint32_t { still = 1, mobile = 2, both = still | mobile };

  /// Stored in post-order: the right child is the node before, the left child is `link`, the root is last.
  /// A leaf's `link` is its block; blocks stand in the order of their leaves. Children precede parents, so
  /// one sweep refits.
  struct alignas(16) Node {
    float min[3];
    std::uint32_t info;
    float max[3];
    std::uint32_t link;
    std::uint32_t flags() const { return info & both; }
    bool leaf() const { return (info & leaf_bit) != 0; }
  };
  static_assert(sizeof(Node) == 32);

  /// Builds over boxes[i] for each i of `active` (ascending). `flags[i]` is a union of Flag; when empty, all
  /// are `mobile`. Boxes that are none (NaN, inverted) do not enter; see refused().
  void build(std::span<const Aabb> boxes, std::span<const std::uint32_t> active, std::span<const std::uint8_t> flags = {});
  /// New boxes and flags for the same objects, all of them valid boxes; the structure stays.
  void refit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags = {});
  /// Cost of traversal now over what it was after the last build: 1 after a build, infinite or NaN when a box
  /// became unbounded. Worth a rebuild above 1.3 or so.
  float growth() const { return cost_ / built_cost_; }

  std::span<const Node> nodes() const { return {nodes_.data(), nodes_.size()}; }
  std::span<const BoxBlock> blocks() const { return {blocks_.data(), blocks_.size()}; }
  /// Objects that are kept out of the tree and are tested one by one: unbounded boxes (planes), and up to
  /// `max_large` boxes much larger than the others that span more than a quarter of the scene. `link` is the object.
  std::span<const Node> large() const { return {large_.data(), large_.size()}; }
  static constexpr std::size_t max_large = 64;
  std::span<const std::uint32_t> refused() const { return refused_; }
  /// Whether the last build needed 63-bit codes because more than 1 % of the 30-bit ones were equal.
  bool wide_codes() const { return wide_; }

  /// Calls visit(index) for every object whose box overlaps `box`, until visit returns false.
  template <class Visit> void query(const Aabb& box, Visit&& visit) const;
  /// Calls visit(i, j) once for every overlapping pair that `Flag` asks for, i and j in no order, until visit
  /// returns false. Returns false when it was stopped so.
  template <class Visit> bool pairs(Visit&& visit) const;
  /// The number of pairs with at least one `mobile` object that overlap, moved or not. Groups of objects that
  /// all overlap each other are counted by multiplication, so that billions are counted in a moment.
  std::uint64_t count_pairs() const;

  static bool overlap(const Node& a, const Node& b);

 private:
  static constexpr std::uint32_t leaf_bit = 4;
  static constexpr std::uint32_t moved_bit = 8;  // something below is not still
  // Lanes next to box sides are compared as floats as well; this bit keeps them out of the subnormals,
  // on which some processors are slow.
  static constexpr std::uint32_t normal_bit = 1u << 30;
  struct WideCode {
    std::uint64_t code;
    std::uint32_t index;
  };
  struct Frame {  // of the Morton codes: a cube
    float origin[3], cells_per_metre;
  };
  struct Scene {
    Frame frame;
    float side, typical_side;  // of the cube, and of a box
  };

  Scene measure(std::span<const Aabb> boxes);
  void set_aside_large(std::span<const Aabb> boxes, const Scene& scene, std::span<const std::uint8_t> flags);
  void sort_codes(std::span<const Aabb> boxes, const Frame& frame);
  void sort_wide_codes(std::span<const Aabb> boxes, const Frame& frame);
  bool many_ties() const;
  template <class Level> void cut_into_blocks(Level level);
  template <class Index> void emit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags, Index index);
  Node load_block(std::uint32_t block, std::span<const Aabb> boxes, std::span<const std::uint8_t> flags);
  static Node object_node(const Aabb& box, std::uint32_t index, std::span<const std::uint8_t> flags);
  static Node inner_node(const Node& left, const Node& right, std::uint32_t left_index);
  void add_cost(const Node& node);

  static bool wanted(const Node& a, const Node& b);
  Node object_of(const BoxBlock& block, std::uint32_t lane) const;
  template <class Visit> bool pairs_with_large(Visit&& visit) const;
  template <class Visit> bool pairs_by_object(Visit&& visit) const;
  template <class Visit> bool pairs_by_descent(Visit&& visit) const;
  template <class Visit> bool pairs_of(const Node& object, std::uint32_t first_node, std::uint32_t first_lane, Visit&& visit) const;
  template <class Visit> bool pairs_within(const BoxBlock& block, Visit&& visit) const;
  template <class Visit> bool pairs_between(const BoxBlock& a, const BoxBlock& b, Visit&& visit) const;

  std::vector<Node> nodes_, large_;
  std::vector<BoxBlock> blocks_;
  std::vector<std::uint8_t> cuts_;  // between neighbours in Morton order: the split's level, 0 within a block
  std::vector<std::uint32_t> bounded_, refused_;
  std::vector<std::uint64_t> codes_, codes_scratch_;  // code << 32 | index
  std::vector<WideCode> wide_codes_, wide_scratch_;
  bool wide_ = false;
  std::size_t moved_count_ = 0;
  float cost_ = 0, built_cost_ = 1;
};

inline bool KdTree::overlap(const Node& a, const Node& b) {
#if defined(__SSE2__)
  const __m128 below = _mm_cmple_ps(_mm_load_ps(a.min), _mm_load_ps(b.max));
  const __m128 above = _mm_cmple_ps(_mm_load_ps(b.min), _mm_load_ps(a.max));
  return (_mm_movemask_ps(_mm_and_ps(below, above)) & 7) == 7;
#else
  return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] && b.min[1] <= a.max[1] &&
         a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
#endif
}

inline bool KdTree::wanted(const Node& a, const Node& b) {
  return ((a.info | b.info) & moved_bit) && ((a.info | b.info) & mobile) && overlap(a, b);
}

template <class Visit> void KdTree::query(const Aabb& box, Visit&& visit) const {
  const Node key = object_node(box, 0, {});
  for (const Node& node : large_)
    if (overlap(node, key) && !visit(node.link)) return;
  pairs_of(key, 0, 0, [&](std::uint32_t, std::uint32_t found) { return visit(found); });
}

inline KdTree::Node KdTree::object_of(const BoxBlock& block, std::uint32_t lane) const {
  const Aabb box = block.box(lane);
  const std::uint32_t flags = (block.still >> lane & 1 ? std::uint32_t{still} : moved_bit) | (block.mobile >> lane & 1 ? std::uint32_t{mobile} : 0u);
  return {{box.min[0], box.min[1], box.min[2]}, flags | leaf_bit | normal_bit, {box.max[0], box.max[1], box.max[2]}, block.index[lane]};
}

// Pairs of an object that moved with all still ones, and with moved ones from lane `first_lane` (counted over
// all blocks) and node `first_node` on: of two that both moved the one that stands first reports.
template <class Visit>
bool KdTree::pairs_of(const Node& object, std::uint32_t first_node, std::uint32_t first_lane, Visit&& visit) const {
  if (nodes_.empty()) return true;
  std::array<std::uint32_t, max_depth + 2> stack;  // a node takes one place and leaves at most two
  std::uint32_t height = 0;
  const Node* nodes = nodes_.data();
  // Without a branch on what is found, which no processor could predict.
  const auto meet = [&](std::uint32_t at) {
    const Node& node = nodes[at];
    const std::uint32_t flags = node.info | (object.info & mobile) | (at >= first_node ? still : 0u);
    stack[height] = at;
    height += static_cast<std::uint32_t>((flags & both) == both) & static_cast<std::uint32_t>(overlap(node, object));
  };
  meet(static_cast<std::uint32_t>(nodes_.size()) - 1);
  while (height > 0) {
    const std::uint32_t at = stack[--height];
    if (!nodes[at].leaf()) {
      meet(nodes[at].link);
      meet(at - 1);
      continue;
    }
    const BoxBlock& block = blocks_[nodes[at].link];
    const std::uint32_t start = nodes[at].link * BoxBlock::lanes, skipped = std::min(first_lane - std::min(first_lane, start), BoxBlock::lanes);
    const std::uint32_t allowed = (BoxBlock::all << skipped | block.still) & (object.info & mobile ? BoxBlock::all : block.mobile);
    for (std::uint32_t hits = overlapping_lanes(block, object.min, object.max) & allowed; hits != 0; hits &= hits - 1)
      if (!visit(object.link, block.index[std::countr_zero(hits)])) return false;
  }
  return true;
}

// Object by object: best when few moved.
template <class Visit> bool KdTree::pairs_by_object(Visit&& visit) const {
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    if ((nodes_[i].info & (leaf_bit | moved_bit)) != (leaf_bit | moved_bit)) continue;
    const BoxBlock& block = blocks_[nodes_[i].link];
    for (std::uint32_t lanes = block.moved(); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
      if (!pairs_of(object_of(block, lane), i, nodes_[i].link * BoxBlock::lanes + lane + 1, visit)) return false;
    }
  }
  return true;
}

template <class Visit> bool KdTree::pairs_within(const BoxBlock& block, Visit&& visit) const {
  for (std::uint32_t l = 0; l + 1 < block.count; ++l) {
    const std::uint32_t allowed = (block.still >> l & 1 ? block.moved() : BoxBlock::all) & (block.mobile >> l & 1 ? BoxBlock::all : block.mobile);
    for (std::uint32_t hits = overlapping_lanes(block, block, l) & allowed & BoxBlock::all << (l + 1); hits != 0; hits &= hits - 1)
      if (!visit(block.index[l], block.index[std::countr_zero(hits)])) return false;
  }
  return true;
}

template <class Visit> bool KdTree::pairs_between(const BoxBlock& a, const BoxBlock& b, Visit&& visit) const {
  std::uint32_t hits = 0;  // bit 4 i + j: lane i of a, lane j of b
  for (std::uint32_t l = 0; l < a.count; ++l) {
    const std::uint32_t allowed = (a.still >> l & 1 ? b.moved() : BoxBlock::all) & (a.mobile >> l & 1 ? BoxBlock::all : b.mobile);
    hits |= (overlapping_lanes(b, a, l) & allowed) << BoxBlock::lanes * l;
  }
  for (; hits != 0; hits &= hits - 1) {
    const auto bit = static_cast<std::uint32_t>(std::countr_zero(hits));
    if (!visit(a.index[bit / BoxBlock::lanes], b.index[bit % BoxBlock::lanes])) return false;
  }
  return true;
}

// The tree against itself, both sides going down together: best when many moved. A node paired with itself
// stands for all pairs within it.
template <class Visit> bool KdTree::pairs_by_descent(Visit&& visit) const {
  if (nodes_.empty()) return true;
  struct Task {
    std::uint32_t a, b;
  };
  // At most 2 tasks wait per level within a node and 3 per level between two, and one is written ahead.
  std::array<Task, 5 * (max_depth + 1) + 1> stack;
  std::uint32_t height = 0;
  const Node* nodes = nodes_.data();
  constexpr std::uint32_t some = moved_bit | mobile;
  const auto within = [&](std::uint32_t a) {
    if ((nodes[a].info & some) == some) stack[height++] = {a, a};
  };
  const auto between = [&](std::uint32_t a, std::uint32_t b) {
    const Node &x = nodes[a], &y = nodes[b];
    if (((x.info | y.info) & some) == some && overlap(x, y)) stack[height++] = {a, b};
  };
  within(static_cast<std::uint32_t>(nodes_.size()) - 1);
  while (height > 0) {
    const auto [a, b] = stack[--height];
    const Node &x = nodes[a], &y = nodes[b];
    if (a == b) {
      if (x.leaf()) {
        if (!pairs_within(blocks_[x.link], visit)) return false;
      } else {
        within(a - 1);
        within(x.link);
        between(x.link, a - 1);
      }
    } else if (x.info & y.info & leaf_bit) {
      if (!pairs_between(blocks_[x.link], blocks_[y.link], visit)) return false;
    } else if (x.leaf()) {
      between(a, b - 1);
      between(a, y.link);
    } else if (y.leaf()) {
      between(a - 1, b);
      between(x.link, b);
    } else {
      between(a - 1, b - 1);
      between(a - 1, y.link);
      between(x.link, b - 1);
      between(x.link, y.link);
    }
  }
  return true;
}

template <class Visit> bool KdTree::pairs_with_large(Visit&& visit) const {
  for (std::size_t i = 0; i < large_.size(); ++i) {
    const Node& a = large_[i];
    for (std::size_t j = i + 1; j < large_.size(); ++j)
      if (wanted(a, large_[j]) && !visit(a.link, large_[j].link)) return false;
    if (a.info & moved_bit) {
      if (!pairs_of(a, 0, 0, visit)) return false;
      continue;
    }
    for (const BoxBlock& block : blocks_) {
      const std::uint32_t allowed = block.moved() & (a.info & mobile ? BoxBlock::all : block.mobile);
      if (allowed == 0) continue;
      for (std::uint32_t hits = overlapping_lanes(block, a.min, a.max) & allowed; hits != 0; hits &= hits - 1)
        if (!visit(a.link, block.index[std::countr_zero(hits)])) return false;
    }
  }
  return true;
}

template <class Visit> bool KdTree::pairs(Visit&& visit) const {
  if (!pairs_with_large(visit)) return false;
  constexpr std::size_t many = 5;  // a fifth: where the two cost the same, see docs/broad-phase.md
  return moved_count_ * many < bounded_.size() ? pairs_by_object(visit) : pairs_by_descent(visit);
}

}  // namespace pcphys
