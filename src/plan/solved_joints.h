// What the solver holds of joints: each as it was made, but of several between the same two bodies one joint
// in their place.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class SolvedJoints {
 public:
  /// Two pins are a hinge about the line through them, three that stand on no line hold the bodies rigidly, pins in one
  /// place are one; two hinges on one line are a hinge, a hinge and a pin beside its axis hold rigidly. Where the two
  /// bodies' pins and axes do not match, the joint is the one that leaves them apart by the least squares. As they are
  /// stay joints that yield, two of which both have a motor, a spring or limits, and cones and limits of more than one
  /// angle where all make a hinge.
  void build(const WorldState& state);

  /// The joint that is solved for; of rows that `stands_back` it is none.
  const JointDef& def(const WorldState& state, std::uint32_t row) const {
    const auto found = merged_.find(row);
    return found == merged_.end() ? state.joints[row].def : found->second;
  }
  /// Whether another row's joint holds in its place.
  bool stands_back(std::uint32_t row) const { return stands_back_[row]; }
  /// Hands them to the kernels: the buffer joint_solved. What joints that stand back last did is forgotten.
  void write(WorldState& state) const;
  std::size_t memory_bytes() const { return bytes_of(merged_, stands_back_); }

 private:
  std::unordered_map<std::uint32_t, JointDef> merged_;  // by row
  std::vector<char> stands_back_;                       // by row
};

}  // namespace pcphys
