// What a device finds islands from (plan/islands.h), and the labels that it leaves:
// of each body the lowest row of its island.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "step/backend.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class IslandLists {
 public:
  /// Follows a change of contacts, joints or kinds of bodies.
  void list(const WorldState& state);
  void forget() { known_ = listed_ = false; }

  bool listed() const { return listed_; }
  /// Whether labels are those of what was listed; where nobody acts on anybody, they are at once.
  bool known() const { return known_; }
  /// The device has been asked. False: they were still falling when it was stopped (constants::most_island_rounds).
  bool take();
  /// By body row, once they are known.
  std::span<const std::uint32_t> labels() const { return labels_; }

  std::vector<std::uint32_t>& ends() { return ends_; }
  std::vector<std::uint32_t>& labels_to_fill() { return labels_; }
  std::span<const Range> edges() const { return std::span(ranges_).first(1); }
  std::span<const Range> rows() const { return std::span(ranges_).last(1); }
  /// Counts the changes of `ends`.
  std::uint64_t version() const { return version_; }
  std::size_t memory_bytes() const { return bytes_of(ends_, labels_); }

 private:
  bool listed_ = false, known_ = false;
  std::vector<std::uint32_t> ends_;    // two body rows an edge
  std::vector<std::uint32_t> labels_;  // by body row; of row 0, which pads, whether they still fell
  std::array<Range, 2> ranges_{};
  std::uint64_t version_ = 0;
};

}  // namespace pcphys
