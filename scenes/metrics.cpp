#include "metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcphys::scenes {
namespace {

/// Roll, pitch and yaw of b's joint frame in a's, as in src/kernels/joint_prepare.inl: R = swing * roll.
struct JointAngles {
  double roll, pitch, yaw, swing;
};

JointAngles angles(Quat frame_a, Quat frame_b) {
  Quat r = conjugate(frame_a) * frame_b;
  if (r.w < 0) r = {-r.x, -r.y, -r.z, -r.w};
  const double n = std::hypot(r.x, r.w);
  const double roll = 2 * std::atan2(r.x, r.w);
  const Quat turn = n > 0 ? Quat{r.x / n, 0, 0, r.w / n} : Quat{};
  const Quat swing = r * conjugate(turn);
  const double s = std::hypot(swing.y, swing.z);
  const double angle = 2 * std::atan2(s, std::fabs(swing.w));
  const double rate = s > 1e-12 ? angle / s : 2;
  return {roll, swing.y * rate, swing.z * rate, angle};
}

double outside(double value, double lower, double upper) { return std::max({0.0, lower - value, value - upper}); }

double excess(const JointDef& joint, Quat qa, Quat qb) {
  const AngleFreedom& freedom = joint.freedom;
  if (freedom.kind == AngleFreedom::Kind::free) return 0;
  const JointAngles is = angles(qa * joint.frame_a.orientation, qb * joint.frame_b.orientation);
  if (freedom.kind == AngleFreedom::Kind::cone_twist)
    return std::max(outside(is.swing, 0, freedom.cone), outside(is.roll, -freedom.twist, freedom.twist));
  return std::max({outside(is.roll, freedom.lower.x, freedom.upper.x), outside(is.pitch, freedom.lower.y, freedom.upper.y),
                   outside(is.yaw, freedom.lower.z, freedom.upper.z)});
}

/// Beyond the walls of the open-lidded box, or below its floor.
bool outside(const Scene& scene, Vec3 p) {
  const double half = 0.5 * scene.inner_width;
  return p.y < 0 || std::fabs(p.x) > half || std::fabs(p.z) > half;
}

}  // namespace

std::vector<Pose> poses(const Scene& scene, const World& world) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Pose> result;
  result.reserve(scene.bodies.size());
  for (const SceneBody& body : scene.bodies) {
    const auto pose = world.pose(body.id);
    result.push_back(pose ? *pose : Pose{{nan, nan, nan}, {}});
  }
  return result;
}

Separation joint_separation(const Scene& scene, const World& world) {
  constexpr double lost = 1e30;  // of a joint whose bodies are nowhere
  Separation result;
  for (JointId joint : scene.joints) {
    const auto distance = world.joint_separation(joint);
    const double d = distance && std::isfinite(*distance) ? *distance : lost;
    result.max = std::max(result.max, d);
    result.mean += d / double(scene.joints.size());
  }
  return result;
}

double limit_excess(const Scene& scene, const World& world) {
  double worst = 0;
  for (JointId id : scene.joints) {
    const auto joint = world.joint(id);
    if (!joint) continue;
    const auto a = world.pose(joint->a), b = world.pose(joint->b);
    if (a && b) worst = std::max(worst, excess(*joint, a->orientation, b->orientation));
  }
  return worst;
}

void RimWatch::look(const Scene& scene, const World& world) {
  if (scene.inner_width == 0) return;
  above_.resize(scene.bodies.size());
  for (std::size_t i = 0; i < above_.size(); ++i) {
    if (scene.bodies[i].kind != BodyKind::dynamic) continue;
    const auto pose = world.pose(scene.bodies[i].id);
    if (!pose) continue;
    if (pose->position.y > scene.wall_height)
      above_[i] = true;
    else if (!outside(scene, pose->position))
      above_[i] = false;
  }
}

Escapes escapes(const Scene& scene, std::span<const Pose> poses, const RimWatch& rim) {
  constexpr double below_floor = 1, far_away = 1000;  // [m]
  Escapes result;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (scene.bodies[i].kind != BodyKind::dynamic) continue;
    const Vec3 p = poses[i].position;
    if (!finite(p)) continue;  // counted by nonfinite()
    if (scene.inner_width > 0)
      (rim.went_over(i) ? result.over_the_rim : result.through) += outside(scene, p);
    else
      result.through +=
          (scene.floor && p.y < *scene.floor - below_floor) || length(p - scene.bodies[i].start.position) > far_away;
  }
  return result;
}

long nonfinite(const Scene& scene, const World& world, std::span<const Pose> poses) {
  long count = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto velocity = world.velocity(scene.bodies[i].id);
    const auto spin = world.angular_velocity(scene.bodies[i].id);
    count +=
        !(finite(poses[i].position) && finite(poses[i].orientation) && velocity && finite(*velocity) && spin && finite(*spin));
  }
  return count;
}

Drift drift(const Scene& scene, std::span<const Pose> poses) {
  constexpr double fallen = 0.5;  // [m]
  Drift result;
  if (scene.supports.empty()) return result;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (scene.bodies[i].kind != BodyKind::dynamic) continue;
    const Vec3 moved = poses[i].position - scene.bodies[i].start.position;
    result.sideways = std::max(result.sideways, std::hypot(moved.x, moved.z));
    result.down = std::max(result.down, -moved.y);
    result.fallen += -moved.y > fallen;
  }
  return result;
}

Metrics measure(const Scene& scene, const World& world, const RimWatch& rim) {
  const std::vector<Pose> now = poses(scene, world);
  Metrics result;
  result.penetration = penetration(scene, world, now);
  result.separation = joint_separation(scene, world);
  result.limit_excess = limit_excess(scene, world);
  result.escapes = escapes(scene, now, rim);
  result.nonfinite = nonfinite(scene, world, now);
  result.drift = drift(scene, now);
  result.kinetic = world.kinetic_energy();
  result.potential = world.potential_energy();
  result.momentum = world.momentum();
  result.angular_momentum = world.angular_momentum();
  return result;
}

}  // namespace pcphys::scenes
