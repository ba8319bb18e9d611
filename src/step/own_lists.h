// The order in which pair kernels and reductions visit rows: that of ids, so that sums do not depend on where rows stand.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "collision/neighbours.h"
#include "plan/own_kernels.h"
#include "world/state.h"

namespace pcphys {

class OwnLists {
 public:
  /// Follows a change of objects.
  void forget() {
    known_ = false;
    near.forget();
  }
  /// What these kernels need, once for each change.
  void order(const WorldState& state, const OwnKernels& kernels);

  std::span<const std::uint32_t> places() const { return std::span(bodies).first(bodies.size() / 2 + 1); }

  std::vector<std::uint32_t> bodies;          // of each row its place, then the row of each place (row 0 has none)
  std::vector<std::uint32_t> moving, joints;  // what sleeps can move, too
  std::uint32_t movable = 0;                  // how many of `moving`
  std::uint64_t version = 0;
  Neighbours near;

 private:
  bool known_ = false;
};

}  // namespace pcphys
