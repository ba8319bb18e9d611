#include "plan/fourth_order.h"

#include <algorithm>
#include <utility>

#include "pcphys/constants.h"
#include "plan/infos.h"
#include "plan/octaves.h"

namespace pcphys {
namespace {

constexpr std::uint32_t bit(SecondOrder why) { return 1u << unsigned(why); }

double trace(const WorldState& state, std::uint32_t row) {
  const Vec3 moments = state.tables.get3(Buffer::mass, row, 0);
  return moments.x + moments.y + moments.z;
}

/// How much a force on a pin turns the body.
double response(const WorldState& state, std::uint32_t row, Vec3 arm) {
  return state.responds(row) ? length(arm) / trace(state, row) : 0;
}

std::uint32_t of_body(const WorldState& state, std::uint32_t row) {
  std::uint32_t why = 0;
  if (!state.responds(row) && !state.stands(row)) why |= bit(SecondOrder::carried);
  if (state.responds(row) &&
      (state.tables.get(Buffer::force, row, 3) > 0 || state.tables.get(Buffer::force, row, 7) > 0))
    why |= bit(SecondOrder::drag);
  return why;
}

std::uint32_t of_joint(const WorldState& state, std::uint32_t row, const SolvedJoints& joints) {
  std::uint32_t why = 0;
  if (state.joints[row].driven()) why |= bit(SecondOrder::drive);
  if (joints.def(state, row).freedom.kind != AngleFreedom::Kind::free) why |= bit(SecondOrder::angles);
  return why;
}

/// Whether some body of the tree spins faster than that [rad/s].
bool spins_faster(const WorldState& state, std::span<const TreeNode> tree, double limit) {
  return std::ranges::any_of(tree, [&](const TreeNode& node) {
    if (!state.responds(node.body)) return false;
    const Vec3 inverse = state.tables.get3(Buffer::mass, node.body, 4);
    const double most = std::max({inverse.x, inverse.y, inverse.z}) * length(state.momentum_of_rotation(node.body));
    return most > limit && length(state.angular_velocity(node.body)) > limit;
  });
}

}  // namespace

std::array<const char*, 2> reason(SecondOrder why) {
  switch (why) {
    case SecondOrder::pivot:
      return {"fourth order of bodies on one pin", "their turning about it is of fourth order already"};
    case SecondOrder::loop:
      return {"fourth order of loops", "a joint that closes one, or a spring, acts from outside of the tree"};
    case SecondOrder::angles: return {"fourth order of joints with angles", "limits and locks act once a sub-step"};
    case SecondOrder::drive: return {"fourth order of driven joints", "motors and springs act once a sub-step"};
    case SecondOrder::drag: return {"fourth order with drag", "drag acts by the exact terms of second order"};
    case SecondOrder::carried: return {"fourth order of what is carried", "a kinematic body may carry several trees"};
    case SecondOrder::contact: return {"fourth order of what is touched", "contacts act once a sub-step"};
    case SecondOrder::stiff:
      return {"fourth order of loaded pins", "they swing too fast for the sub-step without stiffness"};
    case SecondOrder::fast:
      return {"fourth order of fast turns", "it does not stay stable where a sub-step turns a body too far"};
    default: return {"fourth order", "kernels of the host's own act in each sub-step"};
  }
}

void FourthOrder::find_trees(const WorldState& state, const Forest& forest, const SolvedJoints& joints,
                             std::span<const std::uint32_t> closing) {
  if (std::exchange(trees_known_, true)) return;
  tree_of_.assign(state.bodies.size(), 0);
  why_not_.assign(forest.trees(), 0);
  pins_.clear();
  first_pin_.assign(1, 0);
  for (std::uint32_t i = 0; i < forest.trees(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    if (tree.front().flipped) why_not_[i] |= bit(SecondOrder::pivot);
    for (const TreeNode& node : tree) {
      why_not_[i] |= of_body(state, node.body) | (node.joint > 0 ? of_joint(state, node.joint, joints) : 0);
      if (state.responds(node.body)) tree_of_[node.body] = i + 1;
    }
    find_pins(state, tree, joints);
    first_pin_.push_back(std::uint32_t(pins_.size()));
  }
  for (const std::uint32_t row : closing)
    for (const std::uint32_t body :
         {state.body_ids.row(state.joints[row].body_a), state.body_ids.row(state.joints[row].body_b)})
      if (tree_of_[body] > 0) why_not_[tree_of_[body] - 1] |= bit(SecondOrder::loop);
}

void FourthOrder::find_pins(const WorldState& state, std::span<const TreeNode> tree, const SolvedJoints& joints) {
  for (const TreeNode& node : tree.subspan(1)) {
    const JointDef& def = joints.def(state, node.joint);
    const Vec3 own = node.flipped ? def.frame_a.position : def.frame_b.position;
    const Vec3 parents = node.flipped ? def.frame_b.position : def.frame_a.position;
    pins_.push_back({node.joint,
                     std::max(response(state, node.body, own), response(state, tree[node.parent].body, parents)),
                     state.tables.get(Buffer::mass, node.body, 3)});
  }
  if (state.responds(tree.front().body)) return;
  Pin* const first = pins_.data() + pins_.size() - (tree.size() - 1);  // of node 1
  for (std::size_t k = tree.size() - 1; k > 0; k--)
    if (tree[k].parent > 0) first[tree[k].parent - 1].mass += first[k - 1].mass;
}

void FourthOrder::find_touched(const WorldState& state) {
  if (std::exchange(contacts_known_, true)) return;
  touched_.assign(why_not_.size(), false);
  for (const auto& ends : state.contacts.ends)
    for (const std::uint32_t body : ends)
      if (tree_of_[body] > 0) touched_[tree_of_[body] - 1] = true;
}

/// (h w / 2)^2 of what the pins' forces turn fastest, from above: those of the last sub-step, or of the weight that
/// hangs there where that is not known.
double FourthOrder::stiffness(const WorldState& state, std::uint32_t tree, double h) const {
  double most = 0, weight = 0;
  for (std::uint32_t i = first_pin_[tree]; i < first_pin_[tree + 1]; i++) {
    const Pin& pin = pins_[i];
    most = std::max(most, length(state.tables.get3(Buffer::joint_impulse, pin.joint, 0)) * pin.response);
    weight = std::max(weight, pin.mass * length(state.gravity) * pin.response);
  }
  return h * h * (most > 0 && state.last_substep > 0 ? most / state.last_substep : weight);
}

void FourthOrder::choose(const WorldState& state, const Forest& forest, const SolvedJoints& joints,
                         std::span<const std::uint32_t> closing, bool own, const StepSettings& settings, double dt) {
  chosen_.clear();
  bodies_ = reasons_ = 0;
  if (settings.order != 4) return;
  find_trees(state, forest, joints, closing);
  find_touched(state);
  const double h = substep_length(dt, settings.substeps);
  const double fastest = double(1u << highest_octave(settings)) / h;  // a radian in the shortest sub-step
  for (std::uint32_t i = 0; i < why_not_.size(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    std::uint32_t why = why_not_[i];
    if (own) why |= bit(SecondOrder::own_kernel);
    if (touched_[i]) why |= bit(SecondOrder::contact);
    if (why == 0 && stiffness(state, i, h) > 1) why |= bit(SecondOrder::stiff);
    if (why == 0 && spins_faster(state, tree, fastest)) why |= bit(SecondOrder::fast);
    reasons_ |= why;
    if (why != 0) continue;
    chosen_.push_back(i);
    bodies_ +=
        std::uint32_t(std::ranges::count_if(tree, [&](const TreeNode& node) { return state.responds(node.body); }));
  }
}

std::uint32_t FourthOrder::classes(std::uint32_t moving) const {
  return (bodies_ < moving || bodies_ == 0 ? 1u : 0u) | (bodies_ > 0 ? 1u << octave_count : 0u);
}

}  // namespace pcphys
