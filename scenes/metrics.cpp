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

}  // namespace

LimitExcess limit_excess(const JointDef& joint, Quat qa, Quat qb) {
  const AngleFreedom& freedom = joint.freedom;
  if (freedom.kind == AngleFreedom::Kind::free) return {};
  const JointAngles is = angles(qa * joint.frame_a.orientation, qb * joint.frame_b.orientation);
  if (freedom.kind == AngleFreedom::Kind::cone_twist) {
    const double cone = outside(is.swing, 0, freedom.cone);
    return {std::max(cone, outside(is.roll, -freedom.twist, freedom.twist)), cone};
  }
  return {
      std::max({outside(is.roll, freedom.lower.x, freedom.upper.x), outside(is.pitch, freedom.lower.y, freedom.upper.y),
                outside(is.yaw, freedom.lower.z, freedom.upper.z)}),
      0};
}

namespace {

/// The scene's joints with the poses of their bodies.
template <class Action>
void for_each_joint(const Scene& scene, const World& world, std::span<const Pose> poses, Action action) {
  std::vector<const Pose*> of;  // by index of the body's id
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const std::size_t index = scene.bodies[i].id.index;
    if (index >= of.size()) of.resize(index + 1);
    of[index] = &poses[i];
  }
  const auto pose = [&](BodyId body) { return body.index < of.size() && of[body.index] ? *of[body.index] : Pose{}; };
  for (JointId id : scene.joints)
    // the ground has no pose of its own
    if (const auto joint = world.joint(id)) action(*joint, pose(joint->a), pose(joint->b));
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

State state(const Scene& scene, const World& world) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  State result;
  result.poses = poses(scene, world);
  for (const SceneBody& body : scene.bodies) {
    const auto velocity = world.velocity(body.id), spin = world.angular_velocity(body.id);
    result.velocities.push_back(velocity ? *velocity : Vec3{nan, nan, nan});
    result.angular_velocities.push_back(spin ? *spin : Vec3{nan, nan, nan});
  }
  return result;
}

Separation joint_separation(const Scene& scene, const World& world, std::span<const Pose> poses) {
  constexpr double lost = 1e30;  // of a joint whose bodies are nowhere
  Separation result;
  for_each_joint(scene, world, poses, [&](const JointDef& joint, const Pose& a, const Pose& b) {
    const double distance = length(transform(a, joint.frame_a.position) - transform(b, joint.frame_b.position));
    const double d = std::isfinite(distance) ? distance : lost;
    result.max = std::max(result.max, d);
    result.mean += d / double(scene.joints.size());
  });
  return result;
}

LimitExcess limit_excess(const Scene& scene, const World& world, std::span<const Pose> poses) {
  LimitExcess worst;
  for_each_joint(scene, world, poses, [&](const JointDef& joint, const Pose& a, const Pose& b) {
    const LimitExcess here = limit_excess(joint, a.orientation, b.orientation);
    worst = {std::max(worst.any, here.any), std::max(worst.cone, here.cone)};
  });
  return worst;
}

void RimWatch::look(const Scene& scene, std::span<const Pose> poses) {
  if (scene.inner_width == 0) return;
  above_.resize(poses.size());
  for (std::size_t i = 0; i < above_.size(); ++i) {
    if (scene.bodies[i].kind != BodyKind::dynamic) continue;
    if (poses[i].position.y > scene.wall_height)
      above_[i] = true;
    else if (!outside(scene, poses[i].position))
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

long nonfinite(const State& state) {
  long count = 0;
  for (std::size_t i = 0; i < state.poses.size(); ++i)
    count += !(finite(state.poses[i].position) && finite(state.poses[i].orientation) && finite(state.velocities[i]) &&
               finite(state.angular_velocities[i]));
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

Vec3 spin_momentum(const MassProperties& mass, Quat orientation, Vec3 spin) {
  const Vec3 w = rotate(conjugate(orientation), spin);
  return rotate(orientation, {mass.moments.x * w.x, mass.moments.y * w.y, mass.moments.z * w.z});
}

double kinetic_energy(const MassProperties& mass, Quat orientation, Vec3 velocity, Vec3 spin) {
  const Vec3 w = rotate(conjugate(orientation), spin);
  const Vec3 inner{mass.moments.x * w.x, mass.moments.y * w.y, mass.moments.z * w.z};
  return 0.5 * (dot(mass.mass * velocity, velocity) + dot(inner, w));
}

namespace {

/// Adds what one body has of the sums.
void add_motion(Metrics& sums, const MassProperties& mass, const Pose& pose, Vec3 velocity, Vec3 spin, Vec3 gravity) {
  const Vec3 momentum = mass.mass * velocity;
  sums.kinetic += kinetic_energy(mass, pose.orientation, velocity, spin);
  sums.potential -= mass.mass * dot(gravity, pose.position);
  sums.momentum = sums.momentum + momentum;
  sums.angular_momentum =
      sums.angular_momentum + cross(pose.position, momentum) + spin_momentum(mass, pose.orientation, spin);
}

}  // namespace

Metrics measure(const Scene& scene, const World& world, const State& state, const RimWatch& rim) {
  Metrics result;
  result.penetration = penetration(scene, world, state.poses);
  result.separation = joint_separation(scene, world, state.poses);
  result.limit_excess = limit_excess(scene, world, state.poses);
  result.escapes = escapes(scene, state.poses, rim);
  result.nonfinite = nonfinite(state);
  result.drift = drift(scene, state.poses);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].kind != BodyKind::dynamic) continue;
    add_motion(result, *world.mass_properties(scene.bodies[i].id), state.poses[i], state.velocities[i],
               state.angular_velocities[i], world.gravity());
  }
  return result;
}

Metrics measure(const Scene& scene, const World& world, const RimWatch& rim) {
  Metrics result = measure(scene, world, state(scene, world), rim);
  result.momentum = world.momentum();
  result.angular_momentum = world.angular_momentum();
  return result;
}

}  // namespace pcphys::scenes
