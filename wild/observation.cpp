#include "wild/observation.h"

#include <algorithm>
#include <cmath>

#include "scenes/metrics.h"
#include "wild/play.h"

namespace pcphys::wild {
namespace {

template <class T> T& grown(std::vector<T>& list, int number) {
  if (list.size() <= std::size_t(number)) list.resize(std::size_t(number) + 1);
  return list[std::size_t(number)];
}

/// The shortest rotation vector of a unit quaternion.
Vec3 rotation_vector(Quat q) {
  if (q.w < 0) q = {-q.x, -q.y, -q.z, -q.w};
  const Vec3 v{q.x, q.y, q.z};
  const double sine = length(v);
  return sine > 0 ? v * (2 * std::atan2(sine, q.w) / sine) : Vec3{};
}

/// How far a joint's spring is from rest [rad].
double away(const Observation& seen, const SeenJoint& joint) {
  const Quat a = seen.body(joint.a).pose.orientation * joint.def.frame_a.orientation;
  const Quat b = seen.body(joint.b).pose.orientation * joint.def.frame_b.orientation;
  return length(rotation_vector(conjugate(joint.def.spring.rest) * (conjugate(a) * b)));
}
/// How much longer a spring is than at rest [m].
double away(const Observation& seen, const SeenSpring& spring) {
  const Vec3 a = transform(seen.body(spring.a).pose, spring.def.anchor_a);
  return length(transform(seen.body(spring.b).pose, spring.def.anchor_b) - a) - spring.def.rest_length;
}
double energy_of(const Observation& seen, const SeenJoint& joint) {
  const double stiffness = joint.there ? joint.def.spring.stiffness : 0;
  if (stiffness == 0) return 0;
  const double turn = away(seen, joint);
  return 0.5 * stiffness * turn * turn;
}
/// By how much a step of `step` from where a spring is changes its energy.
double energy_of_step(double stiffness, double away, double step) {
  return stiffness * step * (std::fabs(away) + 0.5 * step);
}

}  // namespace

const SeenBody& Observation::body(int number) const {
  static const SeenBody none{true, BodyKind::fixed, {}, {}, {}, {}, {}, {}, 0};
  return number >= 0 && std::size_t(number) < bodies.size() ? bodies[std::size_t(number)] : none;
}

double kinetic_energy(const SeenBody& b) {
  return scenes::kinetic_energy(b.mass, b.pose.orientation, b.velocity, b.angular_velocity);
}

Vec3 angular_momentum_about_centre(const SeenBody& b) {
  return scenes::spin_momentum(b.mass, b.pose.orientation, b.angular_velocity);
}

double spread(const MassProperties& m) { return std::sqrt((m.moments.x + m.moments.y + m.moments.z) / m.mass); }

double kinetic_energy(const Observation& seen) {
  double sum = 0;
  for (const SeenBody& b : seen.bodies)
    if (b.there && b.kind == BodyKind::dynamic) sum += kinetic_energy(b);
  return sum;
}

double potential_energy(const Observation& seen) {
  double sum = 0;
  for (const SeenBody& b : seen.bodies)
    if (b.there && b.kind == BodyKind::dynamic) sum -= b.mass.mass * dot(seen.gravity, b.pose.position);
  return sum;
}

double spring_energy(const Observation& seen, const SeenSpring& spring) {
  if (!spring.there) return 0;
  const double longer = away(seen, spring);
  return 0.5 * spring.def.stiffness * longer * longer;
}

double spring_energy_of_way(const Observation& seen, const SeenSpring& spring, double way) {
  return spring.there ? energy_of_step(spring.def.stiffness, away(seen, spring), way) : 0;
}

double spring_energy(const Observation& seen) {
  double sum = 0;
  for (const SeenJoint& joint : seen.joints) sum += energy_of(seen, joint);
  for (const SeenSpring& spring : seen.springs) sum += spring_energy(seen, spring);
  return sum;
}

double unresolved_speed(const SeenBody& b, double rounding, double dt) {
  return rounding * (length(b.pose.position) + spread(b.mass)) / dt;
}

double unresolved_spring_energy(const Observation& seen, double rounding) {
  double sum = 0;
  for (const SeenJoint& j : seen.joints)
    if (j.there && j.def.spring.stiffness > 0)
      sum += energy_of_step(j.def.spring.stiffness, away(seen, j), 4 * rounding);
  for (const SeenSpring& s : seen.springs) {
    if (!s.there) continue;
    const double reach = length(seen.body(s.a).pose.position) + length(seen.body(s.b).pose.position) +
                         length(s.def.anchor_a) + length(s.def.anchor_b);
    sum += energy_of_step(s.def.stiffness, away(seen, s), rounding * reach);
  }
  return sum;
}

double gap(const Observation& seen, const SeenJoint& joint) {
  const Vec3 a = transform(seen.body(joint.a).pose, joint.def.frame_a.position);
  return length(transform(seen.body(joint.b).pose, joint.def.frame_b.position) - a);
}

double widest_gap(const Observation& seen) {
  double widest = 0;
  for (const SeenJoint& joint : seen.joints)
    if (joint.there) widest = std::max(widest, gap(seen, joint));
  return widest;
}

double largest_excess(const Observation& seen) {
  double largest = 0;
  for (const SeenJoint& j : seen.joints)
    if (j.there)
      largest = std::max(
          largest, scenes::limit_excess(j.def, seen.body(j.a).pose.orientation, seen.body(j.b).pose.orientation).any);
  return largest;
}

void Eye::make(int body, const std::vector<ShapeDef>& shapes, const Material& material, double drag) {
  grown(made_, body) = {shapes, material, drag};
  grown(seen_.bodies, body) = {};
}

const std::vector<ShapeDef>& Eye::shapes(int body) const {
  static const std::vector<ShapeDef> none;
  return body >= 0 && std::size_t(body) < made_.size() ? made_[std::size_t(body)].shapes : none;
}
const Material& Eye::material(int body) const {
  static const Material any;
  return body >= 0 && std::size_t(body) < made_.size() ? made_[std::size_t(body)].material : any;
}

/// What calls change that a judge has to know and the engine does not tell.
struct Eye::Follow {
  Eye& eye;

  void operator()(const MakeBody& c) const {
    eye.make(c.body, c.def.shapes, c.def.material, std::max(c.def.linear_drag, c.def.angular_drag));
  }
  void operator()(const MakeRagdoll& c) const {
    for (std::size_t i = 0; i < c.def.bones.size(); i++) {
      eye.make(c.first_body + int(i), {c.def.bones[i].shape}, c.def.material, 0);
      if (i > 0)
        grown(eye.seen_.joints, c.first_joint + int(i) - 1) = {
            false, c.first_body + c.def.bones[i].parent, c.first_body + int(i), {}};
    }
  }
  void operator()(const MakeJoint& c) const { grown(eye.seen_.joints, c.joint) = {false, c.a, c.b, c.def}; }
  void operator()(const MakeSpring& c) const { grown(eye.seen_.springs, c.spring) = {false, c.a, c.b, c.def}; }
  void operator()(const Destroy& c) const {
    if (c.object == Object::force) grown(eye.forces_, c.number).reset();
  }
  void operator()(const SetMaterial& c) const { grown(eye.made_, c.body).material = c.material; }
  void operator()(const SetDrag& c) const { grown(eye.made_, c.body).drag = std::max(c.linear, c.angular); }
  void operator()(const AddForce& c) const { grown(eye.forces_, c.force) = Force{c.body, c.wrench}; }
  void operator()(const auto&) const {}
};

void Eye::follow(const Call& call) { std::visit(Follow{*this}, call); }

const Observation& Eye::look(const Player& player) {
  const World& world = player.world();
  seen_.gravity = world.gravity();
  for (std::size_t i = 0; i < seen_.bodies.size(); i++) {
    SeenBody& b = seen_.bodies[i];
    const BodyId id = player.body(int(i));
    b.there = world.valid(id);
    if (!b.there) continue;
    b.kind = *world.kind(id);
    b.pose = *world.pose(id);
    b.velocity = *world.velocity(id);
    b.angular_velocity = *world.angular_velocity(id);
    b.mass = *world.mass_properties(id);
    b.force = b.torque = {};
    b.drag = made_[i].drag;
  }
  for (const auto& force : forces_) {
    if (!force || std::size_t(force->body) >= seen_.bodies.size()) continue;
    SeenBody& b = seen_.bodies[std::size_t(force->body)];
    b.force = b.force + force->wrench.force;
    b.torque = b.torque + force->wrench.torque;
  }
  for (std::size_t i = 0; i < seen_.joints.size(); i++) {
    const auto def = world.joint(player.joint(int(i)));
    seen_.joints[i].there = bool(def);
    if (def) seen_.joints[i].def = *def;
  }
  for (std::size_t i = 0; i < seen_.springs.size(); i++) {
    const auto def = world.spring(player.spring(int(i)));
    seen_.springs[i].there = bool(def);
    if (def) seen_.springs[i].def = *def;
  }
  seen_.momentum = world.momentum();
  seen_.angular_momentum = world.angular_momentum();
  return seen_;
}

}  // namespace pcphys::wild
