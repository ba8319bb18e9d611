// Bodies that were destroyed since contacts were found. Their contacts go all at once, when somebody next looks: a body
// may go without a look at any contact.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "world/memory.h"

namespace pcphys {

class ContactDrops {
 public:
  bool any() const { return !dropped_.empty(); }
  /// Memory for so many more.
  void make_room(std::size_t more) {
    pcphys::make_room(dropped_, more);
    before_.reserve(before_.size() + more);
    std::unordered_map<std::uint32_t, std::uint32_t> nodes;
    pcphys::make_room(spare_, 2 * more);
    while (spare_.size() < more) {
      nodes.emplace(0, 0);
      spare_.push_back(nodes.extract(0));
    }
  }
  /// The body of row `row` goes, and that of `last` takes its place.
  void drop(std::uint32_t row, std::uint32_t last) {
    dropped_.push_back(row_before(row));
    const std::uint32_t taken = row_before(last);
    if (auto node = before_.extract(last)) spare_.push_back(std::move(node));
    if (row == last) return;
    if (const auto moved = before_.find(row); moved != before_.end()) {
      moved->second = taken;
      return;
    }
    spare_.back().key() = row;
    spare_.back().mapped() = taken;
    before_.insert(std::move(spare_.back()));
    spare_.pop_back();
  }
  void clear() {
    dropped_.clear();
    before_.clear();
  }

  /// Where there are none.
  void shrink() { *this = ContactDrops(); }

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
  std::size_t memory_bytes() const {
    return bytes_of(dropped_, spare_, before_) + spare_.size() * allocated(2 * sizeof(void*));
  }

 private:
  std::uint32_t row_before(std::uint32_t row) const {
    const auto moved = before_.find(row);
    return moved == before_.end() ? row : moved->second;
  }

  std::vector<std::uint32_t> dropped_;  // rows of then
  std::vector<std::unordered_map<std::uint32_t, std::uint32_t>::node_type> spare_;
  // by row of now, of bodies that were moved, their row of then
  std::unordered_map<std::uint32_t, std::uint32_t> before_;
};

}  // namespace pcphys
