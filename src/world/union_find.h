// Which rows belong together: a union-find (R. Tarjan, J. ACM 22, 1975).
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "world/memory.h"

namespace pcphys {

class UnionFind {
 public:
  explicit UnionFind(std::size_t rows = 0) { reset(rows); }
  /// Each row by itself.
  void reset(std::size_t rows) {
    above_.resize(rows);
    std::iota(above_.begin(), above_.end(), 0u);
  }
  /// The lowest row of those that `row` belongs to, in whatever order they were joined.
  std::uint32_t root(std::uint32_t row) {
    while (above_[row] != row) row = above_[row] = above_[above_[row]];
    return row;
  }
  std::uint32_t root(std::uint32_t row) const {
    while (above_[row] != row) row = above_[row];
    return row;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    above_[high] = low;
  }
  std::size_t memory_bytes() const { return bytes_of(above_); }

 private:
  std::vector<std::uint32_t> above_;
};

}  // namespace pcphys
