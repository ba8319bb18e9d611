#include "plan/tears.h"

#include <algorithm>

#include "pcphys/constants.h"
#include "plan/forest.h"
#include "plan/spin_bounds.h"

namespace pcphys {

void Tears::update_structure(const WorldState& state, const Forest& forest) {
  links_.clear();
  first_.assign(1, 0);
  for (std::size_t i = 0; i < forest.trees(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    if (tree.front().flipped || state.responds(tree.front().body)) continue;
    for (const TreeNode& node : tree.subspan(1)) {
      const JointDef& joint = state.joints[node.joint].def;
      links_.push_back({node.body, tree[node.parent].body, node.joint,
                        length(joint.frame_a.position) + length(joint.frame_b.position), state.size(node.body)});
    }
    first_.push_back(links_.size());
  }
}

std::span<const std::uint32_t> Tears::apart(const WorldState& state) {
  apart_.clear();
  for (std::size_t i = 0; i < trees(); i++) {
    const bool open = std::ranges::any_of(links(i), [&](const Link& link) {
      const Vec3 way = state.tables.get3(Buffer::pose, link.body, 0) - state.tables.get3(Buffer::pose, link.parent, 0);
      const double most = link.reach + constants::tear_apart * link.size;
      return dot(way, way) > most * most;
    });
    if (!open) continue;
    for (const Link& link : links(i)) apart_.push_back(link.body);
  }
  std::ranges::sort(apart_);
  return apart_;
}

bool Tears::torn(const WorldState& state, std::size_t tree) const {
  return std::ranges::any_of(links(tree), [&](const Link& link) {
    const JointRecord& joint = state.joints[link.joint];
    const Pose a = state.pose(state.body_ids.row(joint.body_a)), b = state.pose(state.body_ids.row(joint.body_b));
    const Vec3 gap = transform(a, joint.def.frame_a.position) - transform(b, joint.def.frame_b.position);
    return length(gap) > constants::torn * link.size;
  });
}

template <class Scalar>
void Tears::want_of(const WorldState& state, double h, std::uint8_t octave, std::vector<Wanted>& wanted) const {
  const SpinBounds<Scalar> bounds(state.tables);
  const double fast = constants::whirling / h;
  for (std::size_t i = 0; i < trees(); i++) {
    const bool whirls = std::ranges::any_of(links(i), [&](const Link& link) { return bounds.spin(link.body) > fast * fast; });
    if (whirls && torn(state, i)) wanted.push_back({links(i).back().body, octave});
  }
}

void Tears::want(const WorldState& state, double h, std::uint8_t octave, std::vector<Wanted>& wanted) const {
  if (trees() == 0) return;
  state.tables.precision() == Precision::f32 ? want_of<float>(state, h, octave, wanted)
                                             : want_of<double>(state, h, octave, wanted);
}

std::uint32_t Tears::find_unresolved(const WorldState& state, double h) {
  unresolved_.clear();
  std::size_t bodies = 0;
  for (std::size_t i = 0; i < trees(); i++) {
    double turn = 0;
    for (const Link& link : links(i))
      if (state.responds(link.body)) turn = std::max(turn, h * length(state.angular_velocity(link.body)));
    if (!(turn > constants::largest_joint_turn) || !torn(state, i)) continue;
    unresolved_.push_back({i, constants::largest_joint_turn / turn});
    bodies += links(i).size();
  }
  return std::uint32_t(bodies);
}

void Tears::slow(WorldState& state) const {
  for (const auto& [tree, share] : unresolved_) {
    const std::uint32_t root = links(tree).front().parent;
    const bool driven = state.bodies[root].kind == BodyKind::kinematic;
    const Vec3 centre = state.pose(root).position;
    const Vec3 v0 = driven ? state.velocity(root) : Vec3{}, w0 = driven ? state.angular_velocity(root) : Vec3{};
    for (const Link& link : links(tree)) {
      if (!state.responds(link.body)) continue;
      const Vec3 v = state.velocity(link.body), w = state.angular_velocity(link.body);
      const Vec3 carried = v0 + cross(w0, state.pose(link.body).position - centre);
      state.bring_in_phase(link.body);
      state.tables.set3(Buffer::motion, link.body, 0, carried + share * (v - carried));
      state.set_angular_velocity(link.body, w0 + share * (w - w0));
    }
  }
}

}  // namespace pcphys
