// A midpoint KD-tree over boxes, built as a binary radix tree over Morton codes (T. Karras, Maximizing
// Parallelism in the Construction of BVHs, Octrees, and k-d Trees, HPG 2012): with the bits of the three
// axes interleaved, each level halves a cell along the next axis, and levels with nothing on one side are
// left out. Equal codes are split by the bits of their position in the order. Each node carries tight boxes,
// and takes up its descendants until it has up to four, which are then tested together.
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
#include "world/memory.h"

namespace pcphys {

class KdTree {
 public:
  /// Levels below the root at most: 63 code bits and 32 index bits, each of which splits a path only once.
  static constexpr std::uint32_t max_depth = 95;
  static constexpr std::size_t max_large = 64;

  /// What `pairs` looks for: a pair is reported unless both objects are `still` (it is known already) or
  /// neither is `mobile`.
  enum Flag : std::uint32_t { still = 1, mobile = 2 };

  /// Builds over boxes[i] for each i of `active` (ascending). `flags[i]` is a union of Flag; when empty, all
  /// are `mobile`. Boxes that are none (NaN, inverted) do not enter; see refused().
  void build(std::span<const Aabb> boxes, std::span<const std::uint32_t> active,
             std::span<const std::uint8_t> flags = {});
  /// New boxes and flags for the same objects, all of them valid boxes; the structure stays.
  void refit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags = {});
  /// Cost of traversal now over what it was after the last build: 1 after a build, infinite or NaN when a box
  /// became unbounded. Worth a rebuild above 1.3 or so.
  float growth() const { return cost_ / built_cost_; }

  /// First the large objects, which the tree does not hold, then the tree: children before parents, so that
  /// one sweep refits, and the root last.
  std::span<const BoxBlock> blocks() const { return blocks_; }
  /// Blocks of objects that are tested one by one: unbounded boxes (planes), and up to `max_large` boxes much
  /// larger than the others that span more than a quarter of the scene.
  std::span<const BoxBlock> large() const { return std::span(blocks_).first(large_blocks_); }
  /// The box around block i.
  const Aabb& bounds(std::size_t block) const { return bounds_[block]; }
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
  std::size_t memory_bytes() const {
    return bytes_of(blocks_, bounds_, bounded_, large_, refused_, codes_, codes_scratch_, wide_codes_, wide_scratch_);
  }

 private:
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
  struct Bundle {  // what may become a block
    std::array<std::uint32_t, BoxBlock::lanes> index;
    std::uint32_t count;
    bool leaf;
  };
  struct Object {
    Aabb box;
    std::uint32_t index;
    bool mobile;
  };

  Scene measure(std::span<const Aabb> boxes);
  void set_aside_large(std::span<const Aabb> boxes, const Scene& scene);
  void sort_codes(std::span<const Aabb> boxes, const Frame& frame);
  void sort_wide_codes(std::span<const Aabb> boxes, const Frame& frame);
  bool many_ties() const;
  template <class Index, class Level>
  void emit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags, Index index, Level level);
  Bundle joined(Bundle left, Bundle right, std::span<const Aabb> boxes, std::span<const std::uint8_t> flags);
  Bundle closed(const Bundle& bundle, std::span<const Aabb> boxes, std::span<const std::uint8_t> flags);
  void load(std::size_t block, std::span<const Aabb> boxes, std::span<const std::uint8_t> flags);
  void reset_sums();

  bool has_tree() const { return blocks_.size() > large_blocks_; }
  std::uint32_t root() const { return static_cast<std::uint32_t>(blocks_.size()) - 1; }
  template <class Visit> bool pairs_by_object(Visit&& visit) const;
  template <class Visit> bool pairs_of(const Object& object, std::uint32_t first_lane, Visit&& visit) const;
  template <class Visit> bool pairs_by_descent(Visit&& visit) const;
  template <class Take> static bool take_within(const BoxBlock& block, Take&& take);
  template <class Take> static bool take_between(const BoxBlock& a, const BoxBlock& b, Take&& take);

  std::vector<BoxBlock> blocks_;
  std::vector<Aabb> bounds_;  // of each block
  std::size_t large_blocks_ = 0, objects_ = 0, moved_ = 0;
  float cost_ = 0, built_cost_ = 1;

  std::vector<std::uint32_t> bounded_, large_, refused_;
  std::vector<std::uint64_t> codes_, codes_scratch_;  // code << 32 | index
  std::vector<WideCode> wide_codes_, wide_scratch_;
  bool wide_ = false;
};

template <class Visit> void KdTree::query(const Aabb& box, Visit&& visit) const {
  pairs_of({box, 0, true}, 0, [&](std::uint32_t, std::uint32_t found) { return visit(found); });
}

// Pairs of an object that moved with all still ones, and with moved ones from lane `first_lane` (counted over
// all blocks) on: of two that both moved the one that stands first reports.
template <class Visit> bool KdTree::pairs_of(const Object& object, std::uint32_t first_lane, Visit&& visit) const {
  const auto visit_leaf = [&](std::uint32_t at) {
    const BoxBlock& block = blocks_[at];
    const std::uint32_t start = at * BoxBlock::lanes,
                        skipped = std::min(first_lane - std::min(first_lane, start), BoxBlock::lanes);
    std::uint32_t hits = overlapping_lanes(block, object.box) & block.allowed(true, object.mobile) &
                         (BoxBlock::all << skipped | block.still);
    for (; hits != 0; hits &= hits - 1)
      if (!visit(object.index, block.index[std::countr_zero(hits)])) return false;
    return true;
  };
  for (std::uint32_t i = 0; i < large_blocks_; ++i)
    if (!visit_leaf(i)) return false;
  if (!has_tree()) return true;
  std::array<std::uint32_t, (BoxBlock::lanes - 1) * (max_depth + 2) + 1> stack;
  std::uint32_t height = 0;
  stack[height++] = root();
  while (height > 0) {
    const std::uint32_t at = stack[--height];
    const BoxBlock& block = blocks_[at];
    if (block.leaf) {
      if (!visit_leaf(at)) return false;
      continue;
    }
    const std::uint32_t hits = overlapping_lanes(block, object.box) & block.allowed(true, object.mobile);
    for (std::uint32_t l = 0; l < BoxBlock::lanes; ++l) {
      stack[height] = block.index[l];
      height += hits >> l & 1;
    }
  }
  return true;
}

// Object by object: best when few moved.
template <class Visit> bool KdTree::pairs_by_object(Visit&& visit) const {
  for (std::uint32_t i = 0; i < blocks_.size(); ++i) {
    const BoxBlock& block = blocks_[i];
    if (!block.leaf) continue;
    for (std::uint32_t lanes = block.moved; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
      if (!pairs_of({block.box(lane), block.index[lane], block.mobile_at(lane)}, i * BoxBlock::lanes + lane + 1, visit))
        return false;
    }
  }
  return true;
}

/// take(index, index) for all pairs of lanes of a block that overlap and are asked for.
template <class Take> bool KdTree::take_within(const BoxBlock& block, Take&& take) {
  for (std::uint32_t l = 0; l + 1 < block.count; ++l) {
    const std::uint32_t allowed = block.allowed(block.moved_at(l), block.mobile_at(l)) & BoxBlock::all << (l + 1);
    for (std::uint32_t hits = overlapping_lanes(block, block, l) & allowed; hits != 0; hits &= hits - 1)
      if (!take(block.index[l], block.index[std::countr_zero(hits)])) return false;
  }
  return true;
}

/// The same for lanes of two blocks.
template <class Take> bool KdTree::take_between(const BoxBlock& a, const BoxBlock& b, Take&& take) {
  std::uint32_t hits = 0;  // bit 4 i + j: lane i of a, lane j of b
  for (std::uint32_t l = 0; l < a.count; ++l)
    hits |= (overlapping_lanes(b, a, l) & b.allowed(a.moved_at(l), a.mobile_at(l))) << BoxBlock::lanes * l;
  for (; hits != 0; hits &= hits - 1) {
    const auto bit = static_cast<std::uint32_t>(std::countr_zero(hits));
    if (!take(a.index[bit / BoxBlock::lanes], b.index[bit % BoxBlock::lanes])) return false;
  }
  return true;
}

// The tree against itself, both sides going down together: best when many moved. A block paired with itself
// stands for all pairs within it.
template <class Visit> bool KdTree::pairs_by_descent(Visit&& visit) const {
  struct Task {
    std::uint32_t a, b;
  };
  // A level replaces one task by 16 at most (two blocks) or by 10 (a block with itself).
  std::array<Task, 15 * (max_depth + 2) + 1> stack;
  std::uint32_t height = 0;
  const auto push = [&](std::uint32_t a, std::uint32_t b) {
    stack[height++] = {a, b};
    return true;
  };
  const auto run = [&](std::uint32_t first_a, std::uint32_t first_b) {
    push(first_a, first_b);
    while (height > 0) {
      const auto [at_a, at_b] = stack[--height];
      const BoxBlock &a = blocks_[at_a], &b = blocks_[at_b];
      if (at_a == at_b) {
        if (a.leaf) {
          if (!take_within(a, visit)) return false;
          continue;
        }
        take_within(a, push);
        for (std::uint32_t own = a.moved & a.mobile; own != 0; own &= own - 1) {
          const std::uint32_t child = a.index[std::countr_zero(own)];
          push(child, child);
        }
      } else if (a.leaf && b.leaf) {
        if (!take_between(a, b, visit)) return false;
      } else if (a.leaf || b.leaf) {
        const BoxBlock &leaf = a.leaf ? a : b, &inner = a.leaf ? b : a;
        for (std::uint32_t l = 0; l < inner.count; ++l)
          if (overlapping_lanes(leaf, inner, l) & leaf.allowed(inner.moved_at(l), inner.mobile_at(l)))
            push(a.leaf ? at_a : at_b, inner.index[l]);
      } else {
        take_between(a, b, push);
      }
    }
    return true;
  };
  for (std::uint32_t i = 0; i < large_blocks_; ++i) {
    for (std::uint32_t j = i; j < large_blocks_; ++j)
      if (!run(i, j)) return false;
    if (has_tree() && !run(i, root())) return false;
  }
  return !has_tree() || run(root(), root());
}

template <class Visit> bool KdTree::pairs(Visit&& visit) const {
  // Up to two fifths object by object: there the two cost the same (docs/broad-phase.md).
  return moved_ * 5 < objects_ * 2 ? pairs_by_object(visit) : pairs_by_descent(visit);
}

}  // namespace pcphys
