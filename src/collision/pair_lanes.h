// Pairs of the narrow phase that go in lanes, gathered by kind, and their manifolds,
// found by the pair's place in its batch.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "collision/narrow_lanes.h"
#include "pcphys/types.h"
#include "world/memory.h"

namespace pcphys {

/// In the order of the contact's bodies.
inline PairKind pair_kind(ShapeKind a, ShapeKind b) {
  if (a == ShapeKind::sphere)
    return b == a ? PairKind::spheres : b == ShapeKind::box ? PairKind::sphere_box : PairKind::other;
  if (a == ShapeKind::capsule)
    return b == a ? PairKind::capsules : b == ShapeKind::box ? PairKind::capsule_box : PairKind::other;
  return PairKind::other;
}

/// Numbers in ascending order, however they came.
class Marks {
 public:
  void clear(std::size_t count) { words_.assign((count + 63) / 64, 0); }
  void set(std::uint32_t i) { words_[i / 64] |= std::uint64_t(1) << i % 64; }
  template <class Do> void each(Do&& act) const {
    for (std::size_t w = 0; w < words_.size(); w++)
      for (std::uint64_t left = words_[w]; left != 0; left &= left - 1)
        act(std::uint32_t(w * 64) + std::uint32_t(__builtin_ctzll(left)));
  }
  std::size_t memory_bytes() const { return bytes_of(words_); }

 private:
  std::vector<std::uint64_t> words_;
};

template <class Scalar> class PairLanes {
 public:
  /// Fewer than these of a kind are not worth whole lanes.
  static constexpr std::uint32_t few = 3;

  /// Room for so many pairs; none are listed.
  void begin(std::size_t pairs) {
    if (slots_.size() < pairs) slots_.resize(pairs);
    for (List& list : lists_) {
      list.count = 0;
      if (list.pairs.size() >= pairs + padding) continue;
      for (auto* column : {&list.pairs, &list.a, &list.b}) column->resize(pairs + padding);
      list.margins.resize((pairs + padding) * sizeof(Scalar));
    }
  }
  std::size_t memory_bytes() const { return bytes_of(lists_, manifolds_, places_, slots_); }
  /// a, b: rows, in the order of the contact's bodies. A kind in lanes.
  void add(PairKind kind, std::uint32_t pair, std::uint32_t a, std::uint32_t b, Scalar margin) {
    List& list = lists_[std::size_t(kind)];
    const std::uint32_t i = list.count++;
    list.pairs[i] = pair;
    list.a[i] = a;
    list.b[i] = b;
    reinterpret_cast<Scalar*>(list.margins.data())[i] = margin;
  }
  /// The pair is done without lanes.
  void leave(std::uint32_t pair) { slots_[pair] = 0; }
  /// Marks the pairs that have manifolds, and those that were too few to be done or are left open.
  void run(const NarrowLanes<Scalar>& lanes, const Scalar* rows, Marks& marks) {
    std::uint32_t all = 0, found = 0;
    for (const List& list : lists_) all += list.count;
    if (manifolds_.size() < all) manifolds_.resize(all), places_.resize(all);
    for (std::size_t kind = 0; kind < lane_kinds; kind++) {
      List& list = lists_[kind];
      if (list.count < few) {
        for (std::uint32_t i = 0; i < list.count; i++) leave(list.pairs[i]), marks.set(list.pairs[i]);
        continue;
      }
      list.pad();
      const std::uint32_t n = lanes.run[kind](
          {rows, list.a.data(), list.b.data(), reinterpret_cast<const Scalar*>(list.margins.data()), list.count},
          manifolds_.data() + found, places_.data());
      for (std::uint32_t i = 0; i < n; i++) {
        const std::uint32_t pair = list.pairs[places_[i]];
        marks.set(pair);
        slots_[pair] = manifolds_[found + i].count > 0 ? found + i + 1 : 0;
      }
      found += n;
    }
  }
  /// Of a marked pair; null where it was left.
  Manifold<Scalar>* manifold(std::uint32_t pair) { return slots_[pair] ? &manifolds_[slots_[pair] - 1] : nullptr; }

 private:
  static constexpr std::uint32_t padding = 8;
  struct List {
    std::vector<std::uint32_t> pairs, a, b;
    AlignedBytes margins;
    std::uint32_t count = 0;

    std::size_t memory_bytes() const { return bytes_of(pairs, a, b, margins); }
    void pad() {
      for (std::uint32_t i = count; i < count + padding; i++) a[i] = a[0], b[i] = b[0];
    }
  };

  std::array<List, lane_kinds> lists_;
  std::vector<Manifold<Scalar>> manifolds_;
  std::vector<std::uint32_t> places_;  // of the manifolds of one list
  std::vector<std::uint32_t> slots_;   // by pair: 1 + place of its manifold; 0: none
};

}  // namespace pcphys
