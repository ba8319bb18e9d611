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

struct Link {
  std::uint64_t bodies;  // pair_key
  bool driven;
  std::uint32_t id, row;
};

/// By bodies; of each two first the joint that will stand for all: the driven one, else the oldest.
std::vector<Link> links_by_bodies(const WorldState& state) {
  std::vector<Link> links;
  for (std::uint32_t row = 1; row < state.joints.size(); row++) {
    const JointRecord& j = state.joints[row];
    if (!j.spring) links.push_back({WorldState::pair_key(j.body_a, j.body_b), j.driven(), j.index, row});
  }
  const auto bodies = [](const Link& l) { return l.bodies; };
  std::vector<Link> scratch(links.size());
  if (radix_sort(links.data(), scratch.data(), links.size(), 0, 64, bodies) != links.data()) links.swap(scratch);
  for (auto begin = links.begin(); begin != links.end();) {
    const auto end = std::find_if(begin, links.end(), [&](const Link& l) { return l.bodies != begin->bodies; });
    std::ranges::sort(begin, end, {}, [](const Link& l) { return std::tuple(!l.driven, l.id); });
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

/// The pins of both bodies about their means.
struct Pins {
  Eigen::Matrix3Xd a, b;
  Eigen::Vector3d mean_a, mean_b;
};
Pins pins_of(const WorldState& state, std::span<const Link> links) {
  const std::uint32_t first = state.joints[links[0].row].body_a;
  Pins p{Eigen::Matrix3Xd(3, links.size()), Eigen::Matrix3Xd(3, links.size()), {}, {}};
  for (std::size_t i = 0; i < links.size(); i++) {
    const JointRecord& j = state.joints[links[i].row];
    const bool turned = j.body_a != first;
    p.a.col(Eigen::Index(i)) = Eigen::Vector3d((turned ? j.def.frame_b : j.def.frame_a).position);
    p.b.col(Eigen::Index(i)) = Eigen::Vector3d((turned ? j.def.frame_a : j.def.frame_b).position);
  }
  p.mean_a = p.a.rowwise().mean();
  p.mean_b = p.b.rowwise().mean();
  p.a.colwise() -= p.mean_a;
  p.b.colwise() -= p.mean_b;
  return p;
}

Quat from_x(const Eigen::Vector3d& axis) { return Quat(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), axis)); }

/// All as one: means meet, and of the rest the turn of b against a that brings it nearest, where the pins tell it (W. Kabsch, Acta
/// Cryst. A32, 1976).
std::optional<JointDef> merge(const WorldState& state, std::span<const Link> links) {
  if (links.size() < 2 || links[1].driven) return {};
  for (const Link& l : links)
    if (state.joints[l.row].def.freedom.kind != AngleFreedom::Kind::free || state.joints[l.row].def.yields()) return {};
  const Pins pins = pins_of(state, links);
  const Eigen::Matrix3d together = pins.a * pins.b.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(together, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double least = constants::apart_pins * size_of(state, state.joints[links[0].row]);
  JointDef def = state.joints[links[0].row].def;
  def.frame_a = {Vec3(pins.mean_a), {}};
  def.frame_b = {Vec3(pins.mean_b), {}};
  const auto directions = (svd.singularValues().array() > least * least).count();
  if (directions == 0) return def;
  if (directions == 1) {
    def.freedom = AngleFreedom::hinge();
    def.frame_a.orientation = from_x(svd.matrixU().col(0));
    def.frame_b.orientation = from_x(svd.matrixV().col(0));
    return def;
  }
  def.freedom = AngleFreedom::locked();
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
