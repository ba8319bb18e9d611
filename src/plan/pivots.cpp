#include "plan/pivots.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pcphys/constants.h"

namespace pcphys {
namespace {

/// A body's inertia about a point: principal moments, and their axes in the body.
struct About {
  Vec3 moments;
  Quat axes;
};

About about(const MassProperties& m, Vec3 arm) {
  const Eigen::Vector3d d = arm, own = m.moments;
  Eigen::Matrix3d inertia = m.mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  inertia.diagonal() += own;
  if (inertia.isDiagonal(0)) return {Vec3(Eigen::Vector3d(inertia.diagonal())), {}};  // the body's own axes
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  return {Vec3(Eigen::Vector3d(solver.eigenvalues())), Quat(Eigen::Quaterniond(axes).normalized())};
}

/// The same of a hinge: nothing turns it about other axes than this.
Vec3 hinge_axis(const Pivot& p, const JointDef& def) {
  return rotate(p.flipped ? def.frame_a.orientation : def.frame_b.orientation, {1, 0, 0});
}
About about_hinge(const MassProperties& m, Vec3 arm, Vec3 axis) {
  const Vec3 own{m.moments.x * axis.x, m.moments.y * axis.y, m.moments.z * axis.z}, off = cross(axis, arm);
  const double infinity = std::numeric_limits<double>::infinity();
  const Quat turn(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), Eigen::Vector3d(axis)));
  return {{dot(axis, own) + m.mass * dot(off, off), infinity, infinity}, turn};
}

bool is_locked(double lower, double upper) { return upper - lower < constants::locked_interval; }
bool is_hinge(const AngleFreedom& f) {
  return f.kind == AngleFreedom::Kind::pitch_yaw_roll && !is_locked(f.lower.x, f.upper.x) &&
         is_locked(f.lower.y, f.upper.y) && is_locked(f.lower.z, f.upper.z) && f.lower.y == 0 && f.lower.z == 0;
}
bool turns_freely(const AngleFreedom& f) {
  return f.kind == AngleFreedom::Kind::free || (is_hinge(f) && std::isinf(f.lower.x) && std::isinf(f.upper.x));
}
/// Whether other angles are locked than a hinge's: turning about the pin would not keep them.
bool is_locked_otherwise(const AngleFreedom& f) {
  if (f.kind == AngleFreedom::Kind::free || is_hinge(f)) return false;
  if (f.kind == AngleFreedom::Kind::cone_twist) return is_locked(-f.twist, f.twist);
  return is_locked(f.lower.x, f.upper.x) || is_locked(f.lower.y, f.upper.y) || is_locked(f.lower.z, f.upper.z);
}

/// By row, the bodies that springs between points pull.
std::vector<bool> sprung_rows(const WorldState& state) {
  std::vector<bool> sprung(state.bodies.size());
  for (std::uint32_t row = 1; row < state.joints.size(); row++) {
    const JointRecord& joint = state.joints[row];
    if (!joint.spring || !joint.driven()) continue;
    for (const std::uint32_t body : {joint.body_a, joint.body_b}) sprung[state.body_ids.row(body)] = true;
  }
  return sprung;
}

}  // namespace

std::vector<Pivot> find_pivots(const Forest& forest, const WorldState& state, const SolvedJoints& joints) {
  std::vector<Pivot> pivots;
  const std::vector<bool> sprung = sprung_rows(state);
  for (std::size_t i = 0; i < forest.trees(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    if (tree.size() != 2 || !state.stands(tree[0].body) || forest.has_loop(i)) continue;
    const std::uint32_t joint = tree[1].joint;
    const AngleFreedom& freedom = joints.def(state, joint).freedom;
    if (state.joints[joint].driven() || sprung[tree[1].body] || is_locked_otherwise(freedom)) continue;
    pivots.push_back({i, tree[1].body, tree[1].joint, tree[1].flipped, !turns_freely(freedom)});
  }
  return pivots;
}

void write_pivots(WorldState& state, const SolvedJoints& joints, std::span<const Pivot> pivots) {
  Tables& t = state.tables;
  for (const Pivot& p : pivots) {
    const JointDef& def = joints.def(state, p.joint);
    const Vec3 arm = p.flipped ? def.frame_a.position : def.frame_b.position;
    const MassProperties mass{t.get(Buffer::mass, p.body, 3), t.get3(Buffer::mass, p.body, 0)};
    const About found = is_hinge(def.freedom) ? about_hinge(mass, arm, hinge_axis(p, def)) : about(mass, arm);
    t.set3(Buffer::joint_pivot, p.joint, 0, {1 / found.moments.x, 1 / found.moments.y, 1 / found.moments.z});
    t.set(Buffer::joint_pivot, p.joint, 3, middle_axis(found.moments));
    t.set4(Buffer::joint_pivot, p.joint, 4, found.axes);
    t.set3(Buffer::joint_pivot, p.joint, 8, arm);
    t.set(Buffer::joint_pivot, p.joint, 11, mass.mass);
  }
}

}  // namespace pcphys
