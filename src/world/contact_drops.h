// Bodies that were destroyed since contacts were found. Their contacts go all at once, when somebody next looks: a body may go without a
// look at any contact.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pcphys {

class ContactDrops {
 public:
  bool any() const { return !dropped_.empty(); }
  /// The body of row `row` goes, and that of `last` takes its place.
  void drop(std::uint32_t row, std::uint32_t last) {
    dropped_.push_back(row_before(row));
    const std::uint32_t taken = row_before(last);
    before_.erase(last);
    if (row != last) before_[row] = taken;
  }
  void clear() {
    dropped_.clear();
    before_.clear();
  }

  static constexpr std::uint32_t gone = 0xffffffffu;
  /// By the row that a body had when contacts were found its row of now, or `gone`.
  std::vector<std::uint32_t> rows_now(std::uint32_t rows_before) const {
    std::vector<std::uint32_t> now(rows_before);
    for (std::uint32_t row = 0; row < rows_before; row++) now[row] = row;
    for (const auto& [row, before] : before_)
      if (before < rows_before) now[before] = row;
    for (const std::uint32_t row : dropped_)
      if (row < rows_before) now[row] = gone;
    return now;
  }

 private:
  std::uint32_t row_before(std::uint32_t row) const {
    const auto moved = before_.find(row);
    return moved == before_.end() ? row : moved->second;
  }

  std::vector<std::uint32_t> dropped_;                       // rows of then
  std::unordered_map<std::uint32_t, std::uint32_t> before_;  // by row of now, of bodies that were moved, their row of then
};

}  // namespace pcphys
