// Islands: bodies that act on each other, by contacts or joints. Kinematic bodies belong to islands, since what they
// carry follows their way from sub-step to sub-step; fixed ones do not.
#pragma once
#include <cstdint>
#include <vector>

#include "world/memory.h"
#include "world/state.h"
#include "world/union_find.h"

namespace pcphys {

/// Calls `join(a, b)` with the rows of every two bodies that act on each other and of which neither stands.
template <class Join> void for_each_edge(const WorldState& state, Join join) {
  const auto join_moving = [&](std::uint32_t a, std::uint32_t b) {
    if (!state.stands(a) && !state.stands(b)) join(a, b);
  };
  for (const auto& [a, b] : state.contacts.ends) join_moving(a, b);
  for (std::uint32_t row = 1; row < state.joints.size(); row++)
    join_moving(state.body_ids.row(state.joints[row].body_a), state.body_ids.row(state.joints[row].body_b));
}

/// On the host.
class Islands {
 public:
  /// Follows a change of contacts, joints or kinds of bodies.
  void forget() { built_ = false; }
  /// Once for each change.
  void build(const WorldState& state);
  /// The lowest row of the body's island.
  std::uint32_t root(std::uint32_t body) const { return rows_.root(body); }
  /// How many bodies the island of that root has.
  std::uint32_t size(std::uint32_t root) const { return size_[root]; }
  std::size_t memory_bytes() const { return bytes_of(rows_, size_); }

 private:
  bool built_ = false;
  UnionFind rows_;
  std::vector<std::uint32_t> size_;  // by body row
};

}  // namespace pcphys
