// A midpoint KD-tree over boxes, built as a binary radix tree over Morton codes (T. Karras, Maximizing
// Parallelism in the Construction of BVHs, Octrees, and k-d Trees, HPG 2012): with the bits of the three
// axes interleaved, each level halves a cell along the next axis, and levels with nothing on one side are
// left out. Nodes carry tight boxes. Equal codes are split by the bits of their position in the order.
//
// The tree is a function of boxes and index order alone, on any executor. What it answers (queries, pairs)
// is a set that does not depend on the tree at all; only the time does.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/aabb.h"

namespace pcphys {

class KdTree {
 public:
  /// Levels below the root at most: 63 code bits and 32 index bits, each of which splits a path only once.
  static constexpr std::uint32_t max_depth = 95;

  /// What `pairs` looks for. A pair is reported when one of the two is `moved` and one (the same or the
  /// other) is `mobile`; inner nodes carry the union of what is below, so whole subtrees are skipped.
  enum Flag : std::uint32_t { moved = 1, mobile = 2, both = moved | mobile };

  /// Stored in post-order: the right child is the node before, the left child is `link`, the root is last.
  /// A leaf's `link` is the index of its box. Children precede parents, so one sweep refits.
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
  /// are `both`. Boxes that are none (NaN, inverted) do not enter; see refused().
  void build(std::span<const Aabb> boxes, std::span<const std::uint32_t> active, std::span<const std::uint8_t> flags = {});
  /// New boxes and flags for the same objects, all of them valid boxes; the structure stays.
  void refit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags = {});
  /// Cost of traversal now over what it was after the last build: 1 after a build, infinite or NaN when a box
  /// became unbounded. Worth a rebuild above 1.3 or so.
  float growth() const { return cost_ / built_cost_; }

  std::span<const Node> nodes() const { return {nodes_.data(), nodes_.size()}; }
  /// Objects that are kept out of the tree and are tested one by one: unbounded boxes (planes), and up to
  /// `max_large` boxes much larger than the others that span more than a quarter of the scene.
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
  template <class Index, class Level>
  void emit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags, Index index, Level level);
  static Node leaf_node(const Aabb& box, std::uint32_t index, std::span<const std::uint8_t> flags);
  static Node inner_node(const Node& left, const Node& right, std::uint32_t left_index);
  template <class Visit> bool pairs_within_tree(Visit&& visit) const;
  template <class Visit> bool pairs_of(const Node& object, Visit&& visit) const;
  template <class Test, class Visit> bool descend(Test&& test, Visit&& visit) const;

  std::vector<Node> nodes_, large_;
  std::vector<std::uint32_t> bounded_, refused_;
  std::vector<std::uint64_t> codes_, codes_scratch_;  // code << 32 | index
  std::vector<WideCode> wide_codes_, wide_scratch_;
  bool wide_ = false;
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

// Visits the leaves below all nodes that pass the test.
template <class Test, class Visit> bool KdTree::descend(Test&& test, Visit&& visit) const {
  if (nodes_.empty() || !test(nodes_.back())) return true;
  std::array<std::uint32_t, max_depth + 1> stack;
  std::uint32_t height = 0, at = static_cast<std::uint32_t>(nodes_.size()) - 1;
  for (;;) {
    const Node& node = nodes_[at];
    bool down = false;
    if (node.leaf()) {
      if (!visit(node)) return false;
    } else {
      const std::uint32_t right = at - 1, left = node.link;
      const bool into_left = test(nodes_[left]), into_right = test(nodes_[right]);
      if (into_left && into_right) stack[height++] = left;
      down = into_left || into_right;
      at = into_right ? right : left;
    }
    if (down) continue;
    if (height == 0) return true;
    at = stack[--height];
  }
}

template <class Visit> void KdTree::query(const Aabb& box, Visit&& visit) const {
  const Node key = leaf_node(box, 0, {});
  for (const Node& node : large_)
    if (overlap(node, key) && !visit(node.link)) return;
  descend([&](const Node& node) { return overlap(node, key); }, [&](const Node& node) { return visit(node.link); });
}

// Pairs of one object that is not in the tree.
template <class Visit> bool KdTree::pairs_of(const Node& object, Visit&& visit) const {
  return descend([&](const Node& node) { return ((node.info | object.info) & both) == both && overlap(node, object); },
                 [&](const Node& node) { return visit(object.link, node.link); });
}

// Both trees of a pair go down together; a pair of a node with itself stands for all pairs within it.
template <class Visit> bool KdTree::pairs_within_tree(Visit&& visit) const {
  if (nodes_.size() < 2 || nodes_.back().flags() != both) return true;
  struct Task {
    std::uint32_t a, b;
  };
  // At most 2 tasks wait per level within a node, 3 per level between two.
  std::array<Task, 5 * (max_depth + 1)> stack;
  std::uint32_t height = 0;
  bool more = true;
  const Node* nodes = nodes_.data();
  const auto meet = [&](std::uint32_t a, std::uint32_t b) {
    const Node &x = nodes[a], &y = nodes[b];
    if (((x.info | y.info) & both) != both || !overlap(x, y)) return;
    if (x.info & y.info & leaf_bit)
      more = more && visit(x.link, y.link);
    else
      stack[height++] = {a, b};
  };
  const auto within = [&](std::uint32_t a) {
    if ((nodes[a].info & (both | leaf_bit)) == both) stack[height++] = {a, a};
  };
  within(static_cast<std::uint32_t>(nodes_.size()) - 1);
  while (height > 0 && more) {
    const auto [a, b] = stack[--height];
    const Node &x = nodes[a], &y = nodes[b];
    if (a == b) {
      within(a - 1);
      within(x.link);
      meet(x.link, a - 1);
    } else if (x.leaf()) {
      meet(a, b - 1);
      meet(a, y.link);
    } else if (y.leaf()) {
      meet(a - 1, b);
      meet(x.link, b);
    } else {
      meet(a - 1, b - 1);
      meet(a - 1, y.link);
      meet(x.link, b - 1);
      meet(x.link, y.link);
    }
  }
  return more;
}

template <class Visit> bool KdTree::pairs(Visit&& visit) const {
  for (std::size_t i = 0; i < large_.size(); ++i) {
    for (std::size_t j = i + 1; j < large_.size(); ++j) {
      const Node &a = large_[i], &b = large_[j];
      if (((a.info | b.info) & both) == both && overlap(a, b) && !visit(a.link, b.link)) return false;
    }
    if (!pairs_of(large_[i], visit)) return false;
  }
  return pairs_within_tree(visit);
}

}  // namespace pcphys
