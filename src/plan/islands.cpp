#include "plan/islands.h"

#include <numeric>
#include <utility>

namespace pcphys {

void Islands::build(const WorldState& state) {
  if (std::exchange(built_, true)) return;
  parent_.resize(state.bodies.size());
  std::iota(parent_.begin(), parent_.end(), 0u);
  size_.assign(parent_.size(), 1);
  for_each_edge(state, [&](std::uint32_t a, std::uint32_t b) { join(a, b); });
}

std::uint32_t Islands::root(std::uint32_t body) const {
  while (parent_[body] != body) body = parent_[body];
  return body;
}

void Islands::join(std::uint32_t a, std::uint32_t b) {
  const auto find = [&](std::uint32_t body) {
    for (; parent_[body] != body; body = parent_[body]) parent_[body] = parent_[parent_[body]];
    return body;
  };
  a = find(a);
  b = find(b);
  if (a == b) return;
  if (a > b) std::swap(a, b);
  parent_[b] = a;
  size_[a] += size_[b];
}

}  // namespace pcphys
