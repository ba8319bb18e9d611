#include "plan/solved_joints.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>

#include "collision/radix_sort.h"
#include "pcphys/constants.h"

namespace pcphys {
namespace {

/// What a joint asks of the turning of its bodies.
enum class Angles : std::uint8_t { none, hinge, weld, own };
Angles angles_of(const AngleFreedom& f) {
  if (f.kind == AngleFreedom::Kind::free) return Angles::none;
  const auto locked = [](double lower, double upper) { return lower == 0 && upper == 0; };
  if (f.kind != AngleFreedom::Kind::pitch_yaw_roll || !locked(f.lower.y, f.upper.y) || !locked(f.lower.z, f.upper.z))
    return Angles::own;
  return locked(f.lower.x, f.upper.x) ? Angles::weld : Angles::hinge;
}
/// The axes of its frames that it keeps parallel.
std::span<const Vec3> axes_kept(const AngleFreedom& f) {
  static constexpr Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Angles angles = angles_of(f);
  return std::span(axes).first(angles == Angles::hinge ? 1 : angles == Angles::weld ? 3 : 0);
}
bool is_limited(const AngleFreedom& f) {
  const Angles angles = angles_of(f);
  return angles == Angles::own || (angles == Angles::hinge && (std::isfinite(f.lower.x) || std::isfinite(f.upper.x)));
}

struct Link {
  std::uint64_t bodies;  // pair_key
  bool own;              // with a motor, a spring or limits: of such joints one can stand for all
  std::uint32_t id, row;
};

/// By bodies; of each two first the joint that will stand for all: that with something of its own, else the oldest.
std::vector<Link> links_by_bodies(const WorldState& state) {
  std::vector<Link> links;
  for (std::uint32_t row = 1; row < state.joints.size(); row++) {
    const JointRecord& j = state.joints[row];
    if (j.spring) continue;
    links.push_back({WorldState::pair_key(j.body_a, j.body_b), j.driven() || is_limited(j.def.freedom), j.index, row});
  }
  const auto bodies = [](const Link& l) { return l.bodies; };
  std::vector<Link> scratch(links.size());
  if (radix_sort(links.data(), scratch.data(), links.size(), 0, 64, bodies) != links.data()) links.swap(scratch);
  for (auto begin = links.begin(); begin != links.end();) {
    const auto end = std::find_if(begin, links.end(), [&](const Link& l) { return l.bodies != begin->bodies; });
    std::ranges::sort(begin, end, {}, [](const Link& l) { return std::tuple(!l.own, l.id); });
    begin = end;
  }
  return links;
}

/// Radius of gyration of the smaller body of a joint [m].
double size_of(const WorldState& state, const JointRecord& joint) {
  double size = std::numeric_limits<double>::infinity();
  for (const std::uint32_t body : {joint.body_a, joint.body_b}) {
    const std::uint32_t row = state.body_ids.row(body);
    if (!state.responds(row)) continue;
    const Vec3 moments = state.tables.get3(Buffer::mass, row, 0);
    size = std::min(size, std::sqrt((moments.x + moments.y + moments.z) / state.tables.get(Buffer::mass, row, 3)));
  }
  return size;
}

/// What holds two bodies together: the means of the pins in each, and the sum of a b^T over the pins about these and
/// over the axes that joints keep parallel.
struct Held {
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero(), mean_b = Eigen::Vector3d::Zero();
  Eigen::Matrix3d together = Eigen::Matrix3d::Zero();
};
/// `axis`: how long axes are beside pins [m].
Held held_by(const WorldState& state, std::span<const Link> links, double axis) {
  const auto frames = [&](const Link& l) {
    const JointRecord& j = state.joints[l.row];
    const bool turned = j.body_a != state.joints[links[0].row].body_a;
    return turned ? std::pair(j.def.frame_b, j.def.frame_a) : std::pair(j.def.frame_a, j.def.frame_b);
  };
  Held held;
  for (const Link& l : links) {
    const auto [frame_a, frame_b] = frames(l);
    held.mean_a += Eigen::Vector3d(frame_a.position) / double(links.size());
    held.mean_b += Eigen::Vector3d(frame_b.position) / double(links.size());
  }
  for (const Link& l : links) {
    const auto [frame_a, frame_b] = frames(l);
    const Eigen::Vector3d a = Eigen::Vector3d(frame_a.position) - held.mean_a;
    const Eigen::Vector3d b = Eigen::Vector3d(frame_b.position) - held.mean_b;
    held.together += a * b.transpose();
    for (const Vec3 along : axes_kept(state.joints[l.row].def.freedom))
      held.together += Eigen::Vector3d(rotate(frame_a.orientation, axis * along)) *
                       Eigen::Vector3d(rotate(frame_b.orientation, axis * along)).transpose();
  }
  return held;
}

/// The frame turned the shortest way, so that its x axis is this one.
Quat turned_to(const Quat& frame, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d x(rotate(frame, Vec3{1, 0, 0}));
  return Quat(Eigen::Quaterniond::FromTwoVectors(x, axis)) * frame;
}

/// All as one: means meet, and of the rest the turn of b against a that brings it nearest, where pins and axes tell it
/// (W. Kabsch, Acta Cryst. A32, 1976).
std::optional<JointDef> merge(const WorldState& state, std::span<const Link> links) {
  if (links.size() < 2 || links[1].own) return {};
  if (std::ranges::any_of(links, [&](const Link& l) { return state.joints[l.row].def.yields(); })) return {};
  const double least = constants::apart_pins * size_of(state, state.joints[links[0].row]);
  // (axes less than largest_give apart are one)
  const Held held = held_by(state, links, least / constants::largest_give);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(held.together, Eigen::ComputeFullU | Eigen::ComputeFullV);
  JointDef def = state.joints[links[0].row].def;
  def.frame_a.position = Vec3(held.mean_a);
  def.frame_b.position = Vec3(held.mean_b);
  const Eigen::Vector3d sizes = svd.singularValues();  // the largest first
  const int directions = sizes.y() > least * least ? 2 : sizes.x() > least * least ? 1 : 0;
  if (directions == 0) return def;
  if (directions == 1) {
    if (angles_of(def.freedom) == Angles::own) return {};
    if (angles_of(def.freedom) == Angles::none) def.freedom = AngleFreedom::hinge();
    // (a hinge with limits turns about this axis as it did, and says where its angles begin)
    const Eigen::Vector3d axis_a = svd.matrixU().col(0), axis_b = svd.matrixV().col(0);
    const double sign = axis_a.dot(Eigen::Vector3d(rotate(def.frame_a.orientation, Vec3{1, 0, 0}))) < 0 ? -1 : 1;
    def.frame_a.orientation = turned_to(def.frame_a.orientation, sign * axis_a);
    def.frame_b.orientation = turned_to(def.frame_b.orientation, sign * axis_b);
    return def;
  }
  def.freedom = AngleFreedom::locked();
  def.frame_a.orientation = {};
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  def.frame_b.orientation = Quat(Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixV() * u.transpose())).normalized());
  return def;
}

}  // namespace

void SolvedJoints::build(const WorldState& state) {
  merged_.clear();
  stands_back_.assign(state.joints.size(), false);
  const std::vector<Link> links = links_by_bodies(state);
  for (std::size_t begin = 0, end = 0; begin < links.size(); begin = end) {
    while (end < links.size() && links[end].bodies == links[begin].bodies) end++;
    const std::span<const Link> alike = std::span(links).subspan(begin, end - begin);
    const std::optional<JointDef> one = merge(state, alike);
    if (!one) continue;
    merged_.emplace(alike[0].row, *one);
    for (const Link& l : alike.subspan(1)) stands_back_[l.row] = true;
  }
}

void SolvedJoints::write(WorldState& state) const {
  Tables& t = state.tables;
  const AlignedBytes& made = t.bytes(Buffer::joint_frame);
  std::copy_n(made.data(), made.size(), t.bytes(Buffer::joint_solved).data());
  t.touch(Buffer::joint_solved);
  for (const auto& [row, def] : merged_) write_frames(t, Buffer::joint_solved, row, def);
  for (std::uint32_t row = 1; row < stands_back_.size(); row++) {
    if (!stands_back_[row]) continue;
    t.set3(Buffer::joint_impulse, row, 0, {});
    t.set3(Buffer::joint_impulse, row, 4, {});
  }
}

}  // namespace pcphys
