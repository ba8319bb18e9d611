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

void Loops::begin() {
  for (Loop& l : loops_) l.tight = false;
}

double Loops::tension(const WorldState& state, const Loop& loop, double h) const {
  return h > 0 ? length(state.tables.get3(Buffer::joint_impulse, loop.joint, 0)) / h : 0;
}

std::uint8_t Loops::octave(const Loop& loop, double tension, std::uint8_t highest) const {
  return octave_for(h_ * h_ * loop.ratio * tension / 4, constants::loop_stiffness, highest);
}

void Loops::want(const WorldState& state, double h, std::uint8_t highest, std::vector<Wanted>& wanted) {
  h_ = h, highest_ = highest;
  for (Loop& l : loops_) {
    l.assumed = tension(state, l, state.last_substep);
    const std::uint8_t most = l.tight ? highest : octave(l, l.assumed, highest);
    if (most > 0) wanted.push_back({l.body, most});
  }
}

bool Loops::find_tighter(const WorldState& state) {
  bool tighter = false;
  for (Loop& l : loops_) {
    const double now = tension(state, l, h_);
    if (l.tight || now < constants::loop_snap * l.assumed) continue;
    if (octave(l, now, highest_) == octave(l, l.assumed, highest_)) continue;
    tighter = l.tight = true;
  }
  return tighter;
}

}  // namespace pcphys
