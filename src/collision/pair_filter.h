// Which pairs of shapes may ever touch: shapes of other bodies, one of them dynamic, no joint between, filters agree.
// Asked for every pair of boxes that overlap, so what it reads is compact.
#pragma once
#include <cstdint>
#include <vector>

#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class PairFilter {
 public:
  /// Follows a change of the world's structure. The world must stay where it is.
  void rebuild(const WorldState& state);
  /// The same where only joints are others: `changed`, shapes whose pairs must be asked for anew.
  void follow_joints(const WorldState& state, std::vector<std::uint32_t>& changed);

  bool operator()(std::uint32_t shape_a, std::uint32_t shape_b) const {
    const Side &x = sides_[shape_a], &y = sides_[shape_b];
    if (x.body == y.body || !(x.responds || y.responds)) return false;
    if (x.filter.group != 0 && x.filter.group == y.filter.group) {
      if (x.filter.group < 0) return false;
    } else if (!(x.filter.category & y.filter.mask) || !(y.filter.category & x.filter.mask)) {
      return false;
    }
    if (y.body < x.first_barred || y.body > x.last_barred) return true;
    const std::uint32_t place = y.body - x.first_barred;
    if (x.last_barred - x.first_barred < near) return !(x.barred >> place & 1);
    return !state_->no_collide.contains(WorldState::pair_key(x.body, y.body));
  }
  std::size_t memory_bytes() const { return bytes_of(sides_, before_); }

 private:
  struct Bars {
    std::uint32_t first_barred = 1, last_barred = 0;  // bodies that it never touches are in between
    // which of them, from the first on, where there are no more than `near`
    std::uint64_t barred = 0;
    bool known() const { return last_barred - first_barred < near || first_barred > last_barred; }
    friend bool operator==(const Bars&, const Bars&) = default;
  };
  struct Side : Bars {
    std::uint32_t body = 0;  // id index
    bool responds = false;
    Filter filter;
  };
  void bar(const WorldState& state);
  static constexpr std::uint32_t near = 64;  // bodies on joints have ids side by side
  std::vector<Side> sides_;                  // by shape
  std::vector<Bars> before_;
  const WorldState* state_ = nullptr;
};

}  // namespace pcphys
