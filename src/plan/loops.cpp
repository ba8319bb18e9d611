#include "plan/loops.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcphys/constants.h"

namespace pcphys {

namespace {

/// Omega^2 of a body that a force pulls at this arm, over the force, as pc_swing_ratio (joint_prepare.inl): what
/// answers couples across the arm, both directions' sum, times the arm.
/// Inverse moments are principal, the arm in the body.
double swing_ratio(Vec3 inverse_moments, Vec3 arm) {
  const double r2 = dot(arm, arm);
  if (r2 == 0) return 0;
  const Vec3 across{r2 - arm.x * arm.x, r2 - arm.y * arm.y, r2 - arm.z * arm.z};
  return dot(inverse_moments, across) / std::sqrt(r2);
}

}  // namespace

void Loops::find(const WorldState& state, const SolvedJoints& joints, std::span<const std::uint32_t> pulling,
                 std::span<const char> parallel) {
  loops_.clear();
  for (const std::uint32_t row : pulling) {
    if (parallel[row]) continue;
    const JointRecord& joint = state.joints[row];
    const JointDef& def = joints.def(state, row);
    double ratio = 0;
    for (const auto& [body, arm] :
         {std::pair(joint.body_a, def.frame_a.position), std::pair(joint.body_b, def.frame_b.position)})
      if (const std::uint32_t at = state.body_ids.row(body); state.responds(at))
        ratio = std::max(ratio, swing_ratio(state.tables.get3(Buffer::mass, at, 4), arm));
    loops_.push_back(
        {row, state.body_ids.row(state.responds(state.body_ids.row(joint.body_a)) ? joint.body_a : joint.body_b),
         ratio});
  }
}

void Loops::want(const WorldState& state, double impulse_h, double h, std::uint8_t highest,
                 std::vector<Wanted>& wanted) const {
  if (!(impulse_h > 0)) return;
  for (const Loop& loop : loops_) {
    const double tension = length(state.tables.get3(Buffer::joint_impulse, loop.joint, 0)) / impulse_h;
    const std::uint8_t octave = octave_for(h * h * loop.ratio * tension / 4, constants::largest_give, highest);
    if (octave > 0) wanted.push_back({loop.body, octave});
  }
}

}  // namespace pcphys
