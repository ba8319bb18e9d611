#include "wild/balance.h"

#include <algorithm>
#include <cmath>

namespace pcphys::wild {
namespace {

bool is_driven(const SeenBody& b) {
  return b.there && b.kind == BodyKind::kinematic && (b.velocity != Vec3{} || b.angular_velocity != Vec3{});
}

/// How fast a point of a kinematic body goes; 0 for others.
double drive_speed(const Observation& seen, int body, Vec3 point) {
  const SeenBody& b = seen.body(body);
  if (!is_driven(b)) return 0;
  return length(b.velocity) + length(b.angular_velocity) * length(point);
}

/// The fastest anchor of a joint or spring on a kinematic body.
double fastest_anchor(const Observation& seen) {
  double fastest = 0;
  for (const SeenJoint& j : seen.joints) {
    if (!j.there) continue;
    fastest = std::max(fastest, drive_speed(seen, j.a, j.def.frame_a.position));
    fastest = std::max(fastest, drive_speed(seen, j.b, j.def.frame_b.position));
  }
  for (const SeenSpring& s : seen.springs) {
    if (!s.there) continue;
    fastest = std::max(fastest, drive_speed(seen, s.a, s.def.anchor_a));
    fastest = std::max(fastest, drive_speed(seen, s.b, s.def.anchor_b));
  }
  return fastest;
}

/// Of angles that a turning kinematic body forces on its neighbour: its couple is the rest's change of angular
/// momentum.
double fastest_turn(const Observation& seen) {
  double fastest = 0;
  for (const SeenJoint& j : seen.joints)
    for (const int body : {j.a, j.b})
      if (j.there && is_driven(seen.body(body))) fastest = std::max(fastest, length(seen.body(body).angular_velocity));
  return fastest;
}

struct Sums {
  double mass = 0, changed = 0, turned = 0;
};

/// Magnitudes of what changed, body by body: no exchange with a drive is larger than their sum.
Sums changes(const Observation& before, const Observation& after) {
  Sums sums;
  for (std::size_t i = 0; i < after.bodies.size() && i < before.bodies.size(); i++) {
    const SeenBody &a = before.bodies[i], &b = after.bodies[i];
    if (!a.there || !b.there || b.kind != BodyKind::dynamic) continue;
    sums.mass += b.mass.mass;
    sums.changed += b.mass.mass * length(b.velocity - a.velocity);
    sums.turned += length(angular_momentum_about_centre(b) - angular_momentum_about_centre(a));
  }
  return sums;
}

}  // namespace

void Balance::see_scale(const Observation& seen) {
  motion_ = std::max(motion_, kinetic_energy(seen) + spring_energy(seen));
  if (rests_) {
    double lift = 0;
    for (const SeenBody& b : seen.bodies)
      if (b.there && b.kind == BodyKind::dynamic) lift += b.mass.mass * length(seen.gravity) * spread(b.mass);
    lift_ = std::max(lift_, lift);
  }
  see_fall(seen);
}

void Balance::see_fall(const Observation& seen) {
  fall_ = std::max(fall_, std::fabs(potential_energy(seen) - start_potential_));
}

void Balance::begin(const Observation& seen) {
  start_potential_ = potential_energy(seen);
  lowest_ = energy(seen);
  see_scale(seen);
}

void Balance::changed(const Observation& before, const Observation& after) {
  const double change = energy(after) - energy(before);
  offset_ += change;
  put_in_ += std::fabs(change);
  start_potential_ += potential_energy(after) - potential_energy(before);
  see_scale(after);
}

void Balance::stepped(const Observation& seen, double work, double dt) {
  offset_ += work;
  put_in_ += work;
  see_fall(seen);
  double noise = 0;
  for (const SeenBody& b : seen.bodies) {
    if (!b.there || b.kind != BodyKind::dynamic) continue;
    const double slowest = unresolved_speed(b, rounding_, dt);
    noise += 0.5 * b.mass.mass * slowest * slowest;
  }
  if (std::isfinite(noise)) noise_ = std::max(noise_, noise);
  const double balance = energy(seen) - offset_;
  const double scale = motion_ + fall_ + put_in_ + lift_ + noise_;
  if (scale > 0)
    rise_ = std::max(rise_, (balance - lowest_ - allowed_ - 2 * unresolved_spring_energy(seen, rounding_)) / scale);
  if (!std::isfinite(balance)) rise_ = balance;
  lowest_ = std::min(lowest_, balance);
  see_scale(seen);
}

double driven_work(const Observation& before, const Observation& after, double contact_impulses, double dt) {
  double work = 0;
  for (const SeenJoint& j : after.joints)
    if (j.there) work += j.def.motor.torque * std::fabs(j.def.motor.speed) * dt;
  for (std::size_t i = 0; i < after.bodies.size() && i < before.bodies.size(); i++) {
    const SeenBody &a = before.bodies[i], &b = after.bodies[i];
    if (!b.there || b.kind != BodyKind::dynamic || (b.force == Vec3{} && b.torque == Vec3{})) continue;
    work += std::fabs(dot(b.force, b.pose.position - a.pose.position));
    work += length(b.torque) * std::max(length(a.angular_velocity), length(b.angular_velocity)) * dt;
  }
  const double anchor = fastest_anchor(after), turn = fastest_turn(after);
  if (anchor == 0 && turn == 0) return work;
  const Sums sums = changes(before, after);
  const double exchanged = sums.changed + sums.mass * length(after.gravity) * dt + contact_impulses;
  return work + anchor * exchanged + turn * sums.turned;
}

double encounter_work(const Observation& before, const Observation& after, double dt) {
  const bool first = after.bodies[0].kind == BodyKind::kinematic;
  const SeenBody &k0 = before.bodies[first ? 0 : 1], &k1 = after.bodies[first ? 0 : 1];
  const SeenBody &a = before.bodies[first ? 1 : 0], &b = after.bodies[first ? 1 : 0];
  if (b.kind != BodyKind::dynamic || !is_driven(k1)) return 0;
  const double m = b.mass.mass;
  const Vec3 push = (b.velocity - a.velocity) * m - after.gravity * (m * dt);
  // About the kinematic body's centre, which moves; gravity's own couple by the mean arm.
  const Vec3 arm0 = a.pose.position - k0.pose.position, arm1 = b.pose.position - k1.pose.position;
  const Vec3 about0 = cross(arm0, a.velocity * m) + angular_momentum_about_centre(a);
  const Vec3 about1 = cross(arm1, b.velocity * m) + angular_momentum_about_centre(b);
  const Vec3 carried = cross(k1.velocity, (b.pose.position - a.pose.position) * m);
  const Vec3 pulled = cross((arm0 + arm1) * 0.5, after.gravity * (m * dt));
  const Vec3 couple = about1 - about0 + carried - pulled;
  return dot(push, k1.velocity) + dot(couple, k1.angular_velocity);
}

}  // namespace pcphys::wild
