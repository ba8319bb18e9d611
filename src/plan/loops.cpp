#include "plan/loops.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcphys/constants.h"

namespace pcphys {

namespace {

/// Of a body that a force pulls at this arm: arm over the least moment about an axis across it. Moments are principal, the arm in the body.
double swing_ratio(Vec3 moments, Vec3 arm) {
  const double r2 = dot(arm, arm);
  if (r2 == 0) return 0;
  const double along = (moments.x * arm.x * arm.x + moments.y * arm.y * arm.y + moments.z * arm.z * arm.z) / r2;
  const double across = moments.x + moments.y + moments.z - along - std::max({moments.x, moments.y, moments.z});
  return std::sqrt(r2) / std::max(across, std::min({moments.x, moments.y, moments.z}));
}

}  // namespace

void Loops::find(const WorldState& state, const SolvedJoints& joints, std::span<const std::uint32_t> closing) {
  loops_.clear();
  for (const std::uint32_t row : closing) {
    const JointRecord& joint = state.joints[row];
    const JointDef& def = joints.def(state, row);
    double ratio = 0;
    for (const auto& [body, arm] : {std::pair(joint.body_a, def.frame_a.position), std::pair(joint.body_b, def.frame_b.position)})
      if (const std::uint32_t at = state.body_ids.row(body); state.responds(at))
        ratio = std::max(ratio, swing_ratio(state.tables.get3(Buffer::mass, at, 0), arm));
    loops_.push_back(
        {row, state.body_ids.row(state.responds(state.body_ids.row(joint.body_a)) ? joint.body_a : joint.body_b), ratio});
  }
}

void Loops::want(const WorldState& state, double impulse_h, double h, std::uint8_t highest, std::vector<Wanted>& wanted) const {
  if (!(impulse_h > 0)) return;
  for (const Loop& loop : loops_) {
    const double tension = length(state.tables.get3(Buffer::joint_impulse, loop.joint, 0)) / impulse_h;
    const std::uint8_t octave = octave_for(h * h * loop.ratio * tension / 4, constants::largest_give, highest);
    if (octave > 0) wanted.push_back({loop.body, octave});
  }
}

}  // namespace pcphys
