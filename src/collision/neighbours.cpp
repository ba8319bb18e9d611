#include "collision/neighbours.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "pcphys/constants.h"

namespace pcphys {
namespace {

/// Of a new list: the wider, the longer it stands and the more pairs it has.
constexpr double skin = 0.1, spare = 1.5;  // of the cut-off; of the way in a step
/// Kernels compute distances in the world's precision.
constexpr double rounding = 1 + 1e-5;

}  // namespace

double Neighbours::reach(const WorldState& s, std::uint32_t row, double dt) const {
  const double push = length(s.given_force(row)) * s.tables.get(Buffer::motion, row, 3);
  return dt * (length(s.velocity(row)) + dt * (length(s.gravity) + push));
}

bool Neighbours::wide_enough(const WorldState& s, std::span<const std::uint32_t> moving, double dt) const {
  for (std::uint32_t row = 1; row < then_.size(); row++)
    if (!mobile_[row] && !(s.tables.get3(Buffer::pose, row, 0) == then_[row])) return false;
  return std::ranges::all_of(moving, [&](std::uint32_t row) {
    return length(s.tables.get3(Buffer::pose, row, 0) - then_[row]) + reach(s, row, dt) <= margin_[row];
  });
}

void Neighbours::allow(const WorldState& s, std::span<const std::uint32_t> moving, double cutoff, double dt) {
  const std::size_t count = s.bodies.size();
  then_.resize(count);
  margin_.assign(count, 0);
  mobile_.assign(count, 0);
  for (std::uint32_t row = 1; row < count; row++) then_[row] = s.tables.get3(Buffer::pose, row, 0);
  for (const std::uint32_t row : moving) {
    mobile_[row] = 1;
    margin_[row] = std::max(skin * cutoff, spare * reach(s, row, dt));
    if (!needed_.empty()) margin_[row] = std::max(margin_[row], spare * needed_[row]);
  }
}

bool Neighbours::find_pairs(std::span<const std::uint32_t> moving, double cutoff, std::size_t most) {
  const std::size_t count = then_.size();
  boxes_.resize(count);
  flags_.assign(count, 0);
  active_.resize(count > 0 ? count - 1 : 0);
  std::iota(active_.begin(), active_.end(), 1u);
  for (std::uint32_t row = 1; row < count; row++) {
    const double half = (cutoff / 2 + margin_[row]) * rounding;
    const Vec3 p = then_[row];
    boxes_[row] = {{round_down(p.x - half), round_down(p.y - half), round_down(p.z - half)},
                   {round_up(p.x + half), round_up(p.y + half), round_up(p.z + half)}};
  }
  for (const std::uint32_t row : moving) flags_[row] = KdTree::mobile;
  tree_.build(boxes_, active_, flags_);
  pairs_.clear();
  return tree_.pairs([&](std::uint32_t a, std::uint32_t b) {
    const double within = (cutoff + margin_[a] + margin_[b]) * rounding;
    const Vec3 d = then_[b] - then_[a];
    if (dot(d, d) <= within * within) pairs_.push_back({a, b});
    return pairs_.size() <= most;
  });
}

/// Lists in the order of ids, by two counting sorts: of pairs by the place of the other,
/// then by the body whose list it is.
void Neighbours::list(std::span<const std::uint32_t> places) {
  const std::size_t count = then_.size();
  const auto each = [&](const auto& visit) {
    for (const auto [a, b] : pairs_) {
      if (mobile_[a]) visit(a, b);
      if (mobile_[b]) visit(b, a);
    }
  };
  starts_.assign(count + 1, 0);
  first.assign(count + 1, 0);
  each([&](std::uint32_t self, std::uint32_t other) {
    starts_[places[other] + 1]++;
    first[self + 1]++;
  });
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  std::partial_sum(first.begin(), first.end(), first.begin());
  by_other_.resize(2 * std::size_t{first[count]});
  each([&](std::uint32_t self, std::uint32_t other) {
    const std::size_t at = 2 * std::size_t{starts_[places[other]]++};
    by_other_[at] = self;
    by_other_[at + 1] = other;
  });
  rows.resize(std::max<std::size_t>(first[count], 1));  // a device wants something to bind
  starts_.assign(first.begin(), first.end());
  for (std::size_t at = 0; at < by_other_.size(); at += 2) rows[starts_[by_other_[at]]++] = by_other_[at + 1];
}

Status Neighbours::find(const WorldState& s, std::span<const std::uint32_t> moving,
                        std::span<const std::uint32_t> places, double cutoff, double dt, std::size_t most) {
  if (cutoff_ == cutoff && needed_.empty() && wide_enough(s, moving, dt)) return {};
  cutoff_ = 0;
  allow(s, moving, cutoff, dt);
  if (!find_pairs(moving, cutoff, most))
    return Error{ErrorCode::buffer_full, "Within the cut-off of the pair kernels there are more than " +
                                             std::to_string(most) +
                                             " pairs of bodies, for which there is room; raise "
                                             "StepSettings::max_pairs, or make the cut-off smaller. The "
                                             "world is as before the step."};
  list(places);
  cutoff_ = cutoff;
  version++;
  return {};
}

bool Neighbours::find_strays(const WorldState& s, std::span<const std::uint32_t> moving) {
  if (cutoff_ == 0) return false;
  bool strayed = false;
  for (const std::uint32_t row : moving) {
    const double way = length(s.tables.get3(Buffer::pose, row, 0) - then_[row]);
    if (way <= margin_[row]) continue;
    if (needed_.empty()) needed_.assign(then_.size(), 0);
    needed_[row] = std::max(needed_[row], way);
    strayed = true;
  }
  return strayed;
}

}  // namespace pcphys
