// Broad phase with memory: which shapes may touch. Every shape is a proxy with a fat box around its tight
// one; while all tight boxes stay inside, nothing is done. Else only the proxies that left are asked again.
//
// The pairs whose tight boxes overlap are always complete. Which others are listed depends on what was fat
// when, so a caller that wants results free of history tests the tight boxes again.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "collision/kd_tree.h"
#include "world/memory.h"

namespace pcphys {

/// Two proxies with overlapping fat boxes, a < b.
struct Pair {
  std::uint32_t a, b;
  friend constexpr bool operator==(const Pair&, const Pair&) = default;
};

/// What an update did.
struct PairReport {
  bool changed = false;                          // false: pairs() is what it was
  bool rebuilt = false;                          // the tree was built anew, not refitted
  std::uint32_t moved = 0;                       // proxies that got a new fat box
  std::uint32_t added = 0, removed = 0;          // pairs
  std::uint32_t refused = 0, first_refused = 0;  // proxies whose tight box is none (NaN, inverted): they have no pairs
  // The pairs would be more than the capacity. Everything is as before the call; raise the capacity to
  // `pairs_needed` and update again.
  bool overflow = false;
  std::uint64_t pairs_needed = 0;  // set with `overflow`
  bool needed_is_exact = true;     // false: an upper bound, which ignores the filter
};

class PairCache {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;
  /// False for pairs that must never be listed: same body, joint between the two, groups and masks.
  using Filter = bool (*)(const void* context, std::uint32_t a, std::uint32_t b);

  /// Asked when a pair is made; null lists everything. After a change of the filter's mind touch() a proxy of
  /// every pair concerned.
  void set_filter(Filter filter, const void* context);
  /// Most pairs that pairs() may hold.
  void set_capacity(std::uint64_t pairs) { capacity_ = pairs; }
  /// A fat box is larger by `metres`, or by `fraction` of the tight box's largest side if that is less.
  void set_margin(float metres, float fraction);

  /// A proxy is a small index of the caller's choice, such as the row of a shape. Its box is read from the
  /// next update on. Two proxies that never move are never paired; one may still be moved by hand.
  void add(std::uint32_t proxy, bool moves);
  /// Pairs go with the next update; so do the pairs of a proxy that is removed and added again in between.
  void remove(std::uint32_t proxy);
  void set_moves(std::uint32_t proxy, bool moves);
  /// Makes the proxy's pairs anew in the next update; those that the filter still allows keep their memory.
  void touch(std::uint32_t proxy);
  bool has(std::uint32_t proxy) const { return proxy < state_.size() && (state_[proxy] & present); }

  /// tight[proxy] is the box of that proxy; entries of indices without a proxy are ignored.
  PairReport update(std::span<const Aabb> tight);

  /// In ascending order of (a, b).
  std::span<const Pair> pairs() const { return pairs_; }
  /// For each pair its index before the last update, or `none` if it is new (also if a proxy was replaced).
  std::span<const std::uint32_t> previous_index() const { return previous_; }
  /// Proxies that got a new fat box in the last update, ascending.
  std::span<const std::uint32_t> moved() const { return moved_; }
  const Aabb& fat_box(std::uint32_t proxy) const { return fat_[proxy]; }
  const KdTree& tree() const { return tree_; }
  std::size_t memory_bytes() const {
    return bytes_of(tree_, fat_, fat_before_, state_, moved_, active_, previous_, next_previous_, pairs_, next_pairs_,
                    found_, found_scratch_);
  }

 private:
  enum State : std::uint8_t {
    still = KdTree::still,  // cleared while its pairs are made anew
    moves = KdTree::mobile,
    present = 4,
    entered = 8,  // is in the tree
    fresh = 16    // came since the last update: pairs of an earlier proxy of this index are not its own
  };

  float margin_of(std::uint32_t proxy, const Aabb& tight) const;
  bool outgrown(std::uint32_t proxy, const Aabb& tight) const;
  void find_moved(std::span<const Aabb> tight, PairReport& report);
  void renew_fat_boxes(std::span<const Aabb> tight);
  bool renew_tree();
  bool collect(PairReport& report);
  void restore();
  void sort_found();
  void merge(PairReport& report);
  void settle();
  void set_identity();
  bool keeps(const Pair& pair) const {
    constexpr unsigned untouched = entered | still;
    return (state_[pair.a] & state_[pair.b] & untouched) == untouched;
  }
  std::uint64_t key(const Pair& pair) const { return std::uint64_t{pair.a} << index_bits_ | pair.b; }

  Filter filter_ = nullptr;
  const void* context_ = nullptr;
  std::uint64_t capacity_ = 1u << 24;
  float margin_ = 0.05f, margin_fraction_ = 0.125f;

  KdTree tree_;
  bool tree_stale_ = false, someone_left_ = false, identity_ = true;
  unsigned index_bits_ = 0;
  std::vector<Aabb> fat_, fat_before_;  // fat_before_: of moved_, in case of overflow
  std::vector<std::uint8_t> state_;
  std::vector<std::uint32_t> moved_, active_, previous_, next_previous_;
  std::vector<Pair> pairs_, next_pairs_;
  std::vector<std::uint64_t> found_, found_scratch_;
};

}  // namespace pcphys
