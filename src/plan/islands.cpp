#include "plan/islands.h"

#include <utility>

namespace pcphys {

void Islands::build(const WorldState& state) {
  if (std::exchange(built_, true)) return;
  rows_.reset(state.bodies.size());
  size_.assign(state.bodies.size(), 1);
  for_each_edge(state, [&](std::uint32_t a, std::uint32_t b) {
    a = rows_.root(a), b = rows_.root(b);
    if (a == b) return;
    rows_.join(a, b);
    size_[std::min(a, b)] += size_[std::max(a, b)];
  });
}

}  // namespace pcphys
