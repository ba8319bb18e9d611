#include "wild/closings.h"

#include <algorithm>
#include <cstdint>

#include "world/union_find.h"

namespace pcphys::wild {
namespace {

/// Bodies that move and that joints join.
UnionFind joined(const Observation& seen) {
  UnionFind trees(seen.bodies.size());
  for (const SeenJoint& joint : seen.joints)
    if (joint.there && seen.moves(joint.a) && seen.moves(joint.b))
      trees.join(std::uint32_t(joint.a), std::uint32_t(joint.b));
  return trees;
}

}  // namespace

void Closings::opened(std::size_t joint, double gap) {
  if (left_.size() <= joint) left_.resize(joint + 1, 0);
  left_[joint] = gap;
}

double Closings::work(const Observation& before, const Observation& after, double rise) {
  if (left_.empty()) return 0;
  const UnionFind trees = joined(after);
  std::vector<double> closed(after.bodies.size(), 0);  // by the root of what is joined [m]
  for (std::size_t i = 0; i < left_.size() && i < before.joints.size(); i++) {
    const SeenJoint& joint = after.joints[i];
    if (!joint.there || !before.joints[i].there || left_[i] <= 0) continue;
    const double way = std::clamp(gap(before, joint) - gap(after, joint), 0.0, left_[i]);
    left_[i] -= way;
    const int mover = after.moves(joint.a) ? joint.a : joint.b;
    if (after.moves(mover)) closed[trees.root(std::uint32_t(mover))] += way;
  }
  const auto closed_at = [&](int body) { return after.moves(body) ? closed[trees.root(std::uint32_t(body))] : 0; };
  double gained = 0, most = 0;
  for (std::size_t i = 0; i < after.springs.size() && i < before.springs.size(); i++) {
    const SeenSpring &then = before.springs[i], &now = after.springs[i];
    if (!then.there || !now.there) continue;
    const double way = closed_at(now.a) + closed_at(now.b);
    if (way == 0) continue;
    gained += spring_energy(after, now) - spring_energy(before, then);
    most += spring_energy_of_way(before, then, way);
  }
  return std::max(0.0, std::min({rise, gained, most}));
}

}  // namespace pcphys::wild
