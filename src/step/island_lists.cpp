#include "step/island_lists.h"

#include <numeric>

#include "plan/islands.h"

namespace pcphys {

void IslandLists::list(const WorldState& state) {
  ends_.clear();
  for_each_edge(state, [&](std::uint32_t a, std::uint32_t b) { ends_.insert(ends_.end(), {a, b}); });
  labels_.resize(state.bodies.size());
  std::iota(labels_.begin(), labels_.end(), 0u);
  ranges_ = {Range{0, std::uint32_t(ends_.size() / 2)}, Range{0, std::uint32_t(labels_.size())}};
  listed_ = true;
  known_ = ends_.empty();
  version_++;
}

bool IslandLists::take() {
  known_ = labels_[0] == 0;
  return known_;
}

}  // namespace pcphys
