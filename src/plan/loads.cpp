#include "plan/loads.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcphys/constants.h"
#include "plan/tree_paths.h"

namespace pcphys {

void Loads::find(const WorldState& state, const TreeNodes& trees) {
  uneven_.clear();
  for (std::uint32_t row = 1; row < state.contacts.ends.size(); row++) {
    const auto [a, b] = state.contacts.ends[row];
    if (!state.responds(a) || !state.responds(b) || trees.node(a) > 0 || trees.node(b) > 0 || state.asleep(a)) continue;
    const double x = state.tables.get(Buffer::motion, a, 3), y = state.tables.get(Buffer::motion, b, 3);
    if (x >= constants::uneven_masses * y) uneven_.push_back({row, a, x / y});
    if (y >= constants::uneven_masses * x) uneven_.push_back({row, a, -y / x});
  }
}

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

void Loads::find_loops(const WorldState& state, const SolvedJoints& joints, std::span<const std::uint32_t> closing) {
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

void Loads::want(const WorldState& state, const StepSettings& settings, double dt, std::uint8_t highest_octave,
                 std::vector<Wanted>& wanted) const {
  if (uneven_.empty() && loops_.empty()) return;
  const auto want = [&](std::uint32_t body, double value, double aim) {
    if (const std::uint8_t octave = octave_for(value, aim, highest_octave); octave > 0) wanted.push_back({body, octave, true});
  };
  const double h = dt / settings.substeps, frequency = constants::contact_frequency_times_h / h;
  for (const Uneven& u : uneven_) {
    // acceleration that the load would give to what carries it [m/s^2], and how far it is then pressed in [m]
    const double load = -u.ratio * dot(state.tables.get3(Buffer::contact, u.contact, 0), state.gravity);
    const double overlap = load / (frequency * frequency);
    if (overlap > constants::heavy_overlap) want(u.body, overlap, constants::load_overlap);
  }
  if (state.last_substep == 0) return;
  for (const Loop& l : loops_) {
    const double tension = length(state.tables.get3(Buffer::joint_impulse, l.joint, 0)) / state.last_substep;
    want(l.body, h * h * l.ratio * tension / 4, constants::loop_stiffness);
  }
}

}  // namespace pcphys
