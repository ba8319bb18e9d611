#include "collision/pair_filter.h"

#include <algorithm>

namespace pcphys {

void PairFilter::rebuild(const WorldState& state) {
  state_ = &state;
  sides_.assign(state.shapes.size(), {});
  for (std::size_t i = 0; i < sides_.size(); i++) {
    const ShapeRecord& shape = state.shapes[i];
    if (!shape.alive) continue;
    sides_[i].body = shape.body;
    sides_[i].responds = state.responds(state.body_ids.row(shape.body));
    sides_[i].filter = shape.filter;
  }
  bar(state);
}

void PairFilter::follow_joints(const WorldState& state, std::vector<std::uint32_t>& changed) {
  before_.assign(sides_.begin(), sides_.end());
  for (Side& side : sides_) static_cast<Bars&>(side) = {};
  bar(state);
  changed.clear();
  for (std::uint32_t i = 0; i < sides_.size(); i++)
    if (sides_[i] != before_[i] || !before_[i].known()) changed.push_back(i);
}

void PairFilter::bar(const WorldState& state) {
  const auto widen = [&](std::uint32_t body, std::uint32_t other) {
    for (const std::uint32_t shape : state.bodies[state.body_ids.row(body)].shapes) {
      Side& side = sides_[shape];
      const bool first = side.first_barred > side.last_barred;
      side.first_barred = first ? other : std::min(side.first_barred, other);
      side.last_barred = first ? other : std::max(side.last_barred, other);
    }
  };
  const auto mark = [&](std::uint32_t body, std::uint32_t other) {
    for (const std::uint32_t shape : state.bodies[state.body_ids.row(body)].shapes) {
      const std::uint32_t place = other - sides_[shape].first_barred;
      if (place < near) sides_[shape].barred |= std::uint64_t{1} << place;
    }
  };
  const auto each = [&](const auto& act) {
    for (const auto& [key, reason] : state.no_collide) {
      const auto a = std::uint32_t(key >> 32), b = std::uint32_t(key);
      act(a, b);
      act(b, a);
    }
  };
  each(widen);
  each(mark);
}

}  // namespace pcphys
