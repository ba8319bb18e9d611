#include "plan/spins.h"

#include <algorithm>
#include <cmath>

#include "pcphys/constants.h"
#include "plan/forest.h"
#include "plan/islands.h"
#include "plan/spin_bounds.h"

namespace pcphys {

namespace {

/// Whether contacts held a body of the tree in the last step.
template <class Scalar> bool was_touched(const Tables& t, std::span<const TreeNode> tree) {
  const Scalar* phases = t.data<Scalar>(Buffer::motion) + 7;
  return std::ranges::any_of(tree,
                             [&](const TreeNode& node) { return phases[node.body * reals_of(Buffer::motion)] > 0; });
}

/// Whether contacts could hold one in this step.
bool meets_others(const WorldState& state, std::span<const TreeNode> tree) {
  std::uint32_t first = std::uint32_t(state.bodies.size()), last = 0;
  for (const TreeNode& node : tree) {
    if (!state.responds(node.body)) continue;
    first = std::min(first, node.body);
    last = std::max(last, node.body);
  }
  const auto within = [&](std::uint32_t row) {
    return row >= first && row <= last && std::ranges::find(tree, row, &TreeNode::body) != tree.end();
  };
  return std::ranges::any_of(state.contacts.ends, [&](const auto& ends) { return within(ends[0]) || within(ends[1]); });
}

/// Whether the tree is all of its island.
bool is_alone(const WorldState& state, std::span<const TreeNode> tree, Islands& islands) {
  islands.build(state);
  const auto belongs = [&](const TreeNode& node) { return !state.stands(node.body); };
  return islands.size(islands.root(tree.back().body)) == std::ranges::count_if(tree, belongs);
}

/// The fastest spin of a tree's bodies, squared [1/s^2]; 0 where that is below `least`.
struct Fastest {
  std::uint32_t body = 0;
  double square = 0;
};
template <class Scalar>
Fastest fastest_of(const WorldState& state, const SpinBounds<Scalar>& bounds, std::span<const TreeNode> tree,
                   double least) {
  Fastest fastest;
  for (const TreeNode& node : tree) {
    if (!(bounds.spin(node.body) > least * least) || !state.responds(node.body)) continue;
    const Vec3 spin = state.angular_velocity(node.body);
    const double square = dot(spin, spin);
    if (square > least * least && square > fastest.square) fastest = {node.body, square};
  }
  return fastest;
}

/// Whether a joint of the tree stood at a limit in the last step: a stop changes spins at once, which is no whip.
bool at_limit(const WorldState& state, std::span<const TreeNode> tree) {
  return std::ranges::any_of(tree, [&](const TreeNode& node) {
    if (node.joint == 0) return false;
    const AngleFreedom& freedom = state.joints[node.joint].def.freedom;
    if (freedom.kind == AngleFreedom::Kind::free) return false;
    const Vec3 impulse = state.tables.get3(Buffer::joint_impulse, node.joint, 4);
    if (freedom.kind == AngleFreedom::Kind::cone_twist) return impulse != Vec3{};
    const Vec3 low = freedom.lower, high = freedom.upper;
    return (low.x < high.x && impulse.x != 0) || (low.y < high.y && impulse.y != 0) ||
           (low.z < high.z && impulse.z != 0);
  });
}

/// How much the last sub-step changed the spin of one of its bodies, at most [rad/s]; 0 where that is below `least`.
template <class Scalar>
double largest_change(const WorldState& state, const SpinBounds<Scalar>& bounds, std::span<const TreeNode> tree,
                      double least) {
  double change = 0;
  for (const TreeNode& node : tree)
    if (bounds.change(node.body) > least * least && state.responds(node.body))
      change = std::max(change,
                        2 * length(state.spin_of(node.body, state.tables.get3(Buffer::velocity_parts, node.body, 4))));
  return change;
}

/// What a tree that nothing touches needs for its whips.
template <class Scalar>
std::uint8_t octave_for_whip(const WorldState& state, const SpinBounds<Scalar>& bounds, std::span<const TreeNode> tree,
                             double h, std::uint8_t highest) {
  if (was_touched<Scalar>(state.tables, tree)) return 0;
  const double most = constants::largest_give / h;
  const std::uint8_t octave = octave_for(largest_change(state, bounds, tree, most), most, highest);
  return octave > 0 && !meets_others(state, tree) && !at_limit(state, tree) ? octave : 0;
}

template <class Scalar>
void want(const WorldState& state, const Forest& forest, Islands& islands, double h, std::uint8_t highest_octave,
          std::vector<Wanted>& wanted) {
  const SpinBounds<Scalar> bounds(state.tables);
  const double spin_most = constants::largest_joint_turn / h, swing_most = std::sqrt(constants::largest_give) / h;
  for (std::size_t i = 0; i < forest.trees(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    if (tree.front().flipped) continue;  // turns on a pivot
    if (const Fastest fastest = fastest_of(state, bounds, tree, swing_most); fastest.square > 0) {
      // what swings bends limits as a pull does (plan/pulls.h); others would pay for it in one island
      const bool swings =
          has_limits(state, tree) && !was_touched<Scalar>(state.tables, tree) && is_alone(state, tree, islands);
      const double most = swings ? swing_most : spin_most;
      if (const std::uint8_t octave = octave_for(fastest.square, most * most, highest_octave); octave > 0)
        wanted.push_back({fastest.body, octave});
    }
    if (const std::uint8_t octave = octave_for_whip(state, bounds, tree, h, highest_octave); octave > 0)
      wanted.push_back({tree.back().body, octave});
  }
}

}  // namespace

void want_for_spins(const WorldState& state, const Forest& forest, Islands& islands, double h,
                    std::uint8_t highest_octave, std::vector<Wanted>& wanted) {
  if (forest.trees() == 0) return;
  state.tables.precision() == Precision::f32 ? want<float>(state, forest, islands, h, highest_octave, wanted)
                                             : want<double>(state, forest, islands, h, highest_octave, wanted);
}

}  // namespace pcphys
