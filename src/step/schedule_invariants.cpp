#include "step/schedule_invariants.h"

#include <algorithm>
#include <new>

namespace pcphys {
namespace {

std::string said(const char* object, std::size_t at, const char* predicate) {
  return std::string(object) + " " + std::to_string(at) + " " + predicate;
}

/// Kept, so that a warmed-up step allocates nothing, in debug builds either.
thread_local std::vector<std::uint8_t> marks;

/// `rows` pads with row 0.
std::string broken_list(const WorldState& s, std::span<const std::uint32_t> rows) {
  marks.assign(s.bodies.size(), 0);
  for (const std::uint32_t row : rows) {
    if (row >= marks.size()) return said("body row", row, "is to move, and is not there");
    if (row > 0 && (marks[row]++ > 0 || !s.goes(row)))
      return said("body row", row, "is to move twice, or does not move");
  }
  for (std::uint32_t row = 1; row < marks.size(); row++)
    if (s.goes(row) && marks[row] == 0) return said("body row", row, "moves, and is in no list");
  return {};
}

/// Parents stand before children, and each node but the root hangs on a joint with its parent.
std::string broken_tree(const WorldState& s, const TreeSlots& trees, std::span<const TreeNode> tree) {
  for (std::size_t i = 1; i < tree.size(); i++) {
    const TreeNode& node = tree[i];
    if (node.parent >= i) return said("body row", node.body, "stands in its tree before its parent");
    if (node.joint == 0 || node.joint >= s.joints.size() || trees.solved().stands_back(node.joint))
      return said("joint row", node.joint, "is in a tree, and holds nothing there");
    const JointRecord& joint = s.joints[node.joint];
    const std::uint32_t child = s.body_ids.row(node.flipped ? joint.body_a : joint.body_b);
    const std::uint32_t parent = s.body_ids.row(node.flipped ? joint.body_b : joint.body_a);
    if (joint.spring || s.asleep(joint))
      return said("joint row", node.joint, "is in a tree, and is a spring or sleeps");
    if (child != node.body || parent != tree[node.parent].body)
      return said("joint row", node.joint, "is in a tree between other bodies than its own");
  }
  return {};
}

/// Each body that responds is in one tree at most, each joint that holds in one tree or among those that close loops.
std::string broken_forest(const WorldState& s, const TreeSlots& trees) {
  const Forest& forest = trees.forest();
  marks.assign(s.bodies.size() + s.joints.size(), 0);
  std::uint8_t* const of_body = marks.data();
  std::uint8_t* const of_joint = marks.data() + s.bodies.size();
  for (std::size_t t = 0; t < forest.trees(); t++) {
    const std::span<const TreeNode> tree = forest.tree(t);
    if (std::string broken = broken_tree(s, trees, tree); !broken.empty()) return broken;
    for (const TreeNode& node : tree) {
      if (s.responds(node.body) && of_body[node.body]++ > 0) return said("body row", node.body, "stands in two trees");
      if (&node != tree.data() && of_joint[node.joint]++ > 0)
        return said("joint row", node.joint, "stands in two places");
    }
  }
  for (const std::uint32_t row : trees.closing())
    if (row == 0 || row >= s.joints.size() || of_joint[row]++ > 0)
      return said("joint row", row, "closes a loop, and stands elsewhere too");
  for (std::uint32_t row = 1; row < s.joints.size(); row++) {
    const JointRecord& joint = s.joints[row];
    const bool holds = !joint.spring && !trees.solved().stands_back(row) && !s.asleep(joint);
    if (holds && of_joint[row] == 0) return said("joint row", row, "holds, and stands in no tree and closes no loop");
  }
  return {};
}

}  // namespace

std::string broken_invariant(const WorldState& state, const Schedule& schedule) {
  std::string broken = broken_list(state, schedule.rows_that_move());
  if (broken.empty()) broken = broken_list(state, schedule.moving_bodies());
  if (broken.empty()) broken = broken_forest(state, schedule.trees);
  return broken;
}

void walk_invariants(const WorldState& state, const Schedule& schedule) try {
  const std::string broken = broken_invariant(state, schedule);
  if (broken.empty()) return;
  const std::string fault = "A fault of the library, which should be reported: a schedule breaks an invariant. ";
  detail::misuse((fault + broken + ".").c_str());
} catch (const std::bad_alloc&) {}

}  // namespace pcphys
