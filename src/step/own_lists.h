// The order in which pair kernels and reductions visit rows: that of ids, so that sums do not depend on where rows stand.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "plan/own_kernels.h"
#include "step/neighbours.h"
#include "world/state.h"

namespace pcphys {

class OwnLists {
 public:
  /// Follows a change of objects.
  void forget() {
    known_ = false;
    near.forget();
  }
  /// What these kernels need, once for each change. `moving`: rows that move.
  void order(const WorldState& state, std::span<const std::uint32_t> moving, const OwnKernels& kernels);

  std::span<const std::uint32_t> places() const { return std::span(bodies).first(bodies.size() / 2 + 1); }

  std::vector<std::uint32_t> bodies;  // of each row its place, then the row of each place (row 0 has none)
  std::vector<std::uint32_t> moving, joints;
  std::uint64_t version = 0;
  Neighbours near;

 private:
  bool known_ = false;
};

}  // namespace pcphys
