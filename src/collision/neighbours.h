// Bodies near each other, for pair kernels with a cut-off: lists that hold at least all pairs which come within it
// during a step. Kernels look at each distance again, so that what they sum depends on positions alone, never on how
// wide the lists were made.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "collision/kd_tree.h"
#include "pcphys/result.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class Neighbours {
 public:
  /// For a step of `dt` and a cut-off, `moving` and `places` (order of ids, by row) as OwnLists has them. Lists that
  /// are wide enough still stand. Errors: buffer_full for more than `most` pairs.
  Status find(const WorldState& state, std::span<const std::uint32_t> moving, std::span<const std::uint32_t> places,
              double cutoff, double dt, std::size_t most);
  /// After a step: whether some body went further than was allowed for. The next lists allow for it.
  bool find_strays(const WorldState& state, std::span<const std::uint32_t> moving);
  /// The step that strayed was made.
  void forget_strays() { needed_.clear(); }
  /// Follows a change of objects.
  void forget() { cutoff_ = 0; }

  std::vector<std::uint32_t> first,
      rows;  // of a row the neighbours rows[first[row]] to rows[first[row + 1]], in the order of ids
  std::uint64_t version = 0;
  std::size_t memory_bytes() const {
    return bytes_of(first, rows, then_, margin_, needed_, mobile_, pairs_, boxes_, active_, starts_, by_other_, flags_);
  }

 private:
  struct Pair {
    std::uint32_t a, b;
  };
  double reach(const WorldState& state, std::uint32_t row, double dt) const;
  bool wide_enough(const WorldState& state, std::span<const std::uint32_t> moving, double dt) const;
  void allow(const WorldState& state, std::span<const std::uint32_t> moving, double cutoff, double dt);
  bool find_pairs(std::span<const std::uint32_t> moving, double cutoff, std::size_t most);
  void list(std::span<const std::uint32_t> places);

  double cutoff_ = 0;           // that the lists are for; 0: none
  std::vector<Vec3> then_;      // where bodies were, by row
  std::vector<double> margin_;  // how far a body may go from there
  std::vector<double> needed_;  // what a step that strayed asked for
  std::vector<char> mobile_;    // by row
  std::vector<Pair> pairs_;
  std::vector<Aabb> boxes_;
  std::vector<std::uint32_t> active_, starts_, by_other_;
  std::vector<std::uint8_t> flags_;
  KdTree tree_;
};

}  // namespace pcphys
