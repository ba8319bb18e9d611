// The order in which pair kernels and reductions visit rows, and in which a body sums what its joints give it: that of
// ids, so that sums do not depend on where rows stand.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "collision/neighbours.h"
#include "plan/octave_of.h"
#include "plan/own_kernels.h"
#include "step/backend.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class OwnLists {
 public:
  /// Follows a change of objects.
  void forget() {
    ordered_ = joined_ = grouped_ = false;
    near.forget();
  }
  /// Follows a change of octaves.
  void forget_octaves() { grouped_ = false; }
  /// What these kernels need, once for each change.
  void order(const WorldState& state, const OwnKernels& kernels, OctaveOf of_bodies);

  std::span<const std::uint32_t> places() const { return std::span(bodies).first(bodies.size() / 2 + 1); }

  std::vector<std::uint32_t> bodies;          // of each row its place, then the row of each place (row 0 has none)
  std::vector<std::uint32_t> moving, joints;  // what sleeps can move, too
  std::uint32_t movable = 0;                  // how many of `moving`
  /// Joints with a body that goes, by octave: three by three their row and those of bodies a and b.
  std::vector<std::uint32_t> joined;
  Range joined_range(unsigned octave) const { return joined_ranges_[octave]; }
  /// Of each body row where its ends of joints begin, and of the last where they end; then the ends, in the order of
  /// the joints' ids: twice the joint's row, and 1 more where the body is its b.
  std::vector<std::uint32_t> body_joints;
  std::uint64_t version = 0;
  Neighbours near;
  std::size_t memory_bytes() const {
    return bytes_of(bodies, moving, joints, joined, body_joints, near, by_id_, joined_ranges_);
  }

 private:
  struct Joined {
    std::uint32_t row, a, b, goes;  // goes: that of a and b which does
  };
  void order_rows(const WorldState& state);
  void find_joined(const WorldState& state);
  void group_joined(OctaveOf of_bodies);

  std::vector<Joined> by_id_;
  std::vector<Range> joined_ranges_;                         // by octave
  bool ordered_ = false, joined_ = false, grouped_ = false;  // they are of the objects, and octaves, that there are
};

}  // namespace pcphys
