#include "calls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace fuzz {

using namespace pcphys;

namespace {

/// What was made has a place among the host's ids, whether it was refused or not: so places agree.
template <class Id> Outcome keep(std::vector<Id>& ids, const Result<Id>& made) {
  ids.push_back(made ? *made : Id{});
  if (!made) return {made.error().code, {}, made.error().message};
  return {ErrorCode::none, {double(made->index), double(made->generation)}, {}};
}

std::uint32_t draw_body(Choices& c, const Host& host) {
  const auto count = std::uint32_t(host.bodies.size());
  if (count == 0 || c.below(20) == 1) return c.below(2) ? Host::ground : count;
  return c.chance(0.5) ? count - 1 - c.below(std::min(count, 6u)) : c.below(count);
}

ShapeDef draw_shape(Choices& c) {
  static const Hull rock = *make_hull(std::array<Vec3, 6>{Vec3{0.3, 0, 0}, Vec3{-0.2, 0.1, 0}, Vec3{0, 0.4, 0.1},
                                                          Vec3{0, -0.2, 0.2}, Vec3{0.1, 0, -0.3}, Vec3{0, 0.1, 0.3}});
  ShapeDef shape;
  switch (c.below(6)) {
    case 0: shape = ShapeDef::sphere(c.ratio(0.05, 0.5)); break;
    case 1: shape = ShapeDef::capsule(c.ratio(0.05, 0.3), c.ratio(0.05, 0.5)); break;
    case 2: shape = ShapeDef::cylinder(c.ratio(0.05, 0.4), c.ratio(0.05, 0.4)); break;
    case 3: shape = ShapeDef::hull(rock); break;
    default: shape = ShapeDef::box({c.ratio(0.05, 0.5), c.ratio(0.05, 0.5), c.ratio(0.05, 0.5)});
  }
  if (c.below(10) == 1) shape.filter = {c.below(4), c.below(4), int(c.below(3)) - 1};
  return shape;
}

Material draw_material(Choices& c) {
  Material m;
  m.static_friction = c.number(0, 1);
  m.kinetic_friction = c.number(0, 1);
  if (c.below(3) == 1) m.restitution = c.number(0, 1);
  if (c.below(6) == 1) m.rolling_friction = c.number(0, 0.1);
  if (c.below(6) == 1) m.torsional_friction = c.number(0, 0.1);
  m.friction_rule = Combine(c.below(5));
  return m;
}

Pose draw_pose(Choices& c, const Theme& theme) { return {c.vector(theme.size), c.turn()}; }

BodyDef draw_body_def(Choices& c, const Theme& theme) {
  BodyDef def;
  const std::uint32_t kind = c.below(12);
  def.kind = kind == 0 ? BodyKind::fixed : kind == 1 ? BodyKind::kinematic : BodyKind::dynamic;
  def.pose = draw_pose(c, theme);
  if (c.below(3) == 1) def.velocity = c.vector(5);
  if (c.below(3) == 1) def.angular_velocity = c.vector(10);
  for (std::uint32_t i = c.below(12) == 1 ? c.below(4) : 1; i > 0; i--) def.shapes.push_back(draw_shape(c));
  def.density = c.ratio(1, 1e4);
  if (c.below(8) == 1) def.mass = c.ratio(1e-3, 1e3);
  if (c.below(20) == 1) def.moments = Vec3{c.ratio(0.01, 1), c.ratio(0.01, 1), c.ratio(0.01, 1)};
  def.material = draw_material(c);
  if (c.below(6) == 1) def.linear_drag = c.number(0, 2);
  if (c.below(6) == 1) def.angular_drag = c.number(0, 2);
  def.can_sleep = c.below(10) != 1;
  def.rotates = c.below(12) != 1;
  if (def.kind == BodyKind::fixed) def.velocity = def.angular_velocity = {};  // else it is refused
  return def;
}

AngleFreedom draw_freedom(Choices& c) {
  switch (c.below(5)) {
    case 0: return AngleFreedom::hinge();
    case 1: return AngleFreedom::hinge(c.number(-2, 0), c.number(0, 2));
    case 2: return AngleFreedom::cone_and_twist(c.number(0, 2), c.number(0, 2));
    case 3: return AngleFreedom::locked();
    default: return {};
  }
}

Call make_body(Choices& c, const Theme& theme) {
  return {"create_body", [def = draw_body_def(c, theme)](Host& h) { return keep(h.bodies, h.world.create_body(def)); }};
}

Call make_joint(Choices& c, const Host& host) {
  JointDef def;
  def.frame_a = {c.vector(0.5), c.turn()};
  def.frame_b = {c.vector(0.5), c.turn()};
  def.freedom = draw_freedom(c);
  if (c.below(4) == 1) def.motor = {c.number(-5, 5), c.ratio(0.1, 100)};
  if (c.below(4) == 1) def.spring = {c.ratio(0.1, 1000), c.ratio(0.01, 10), c.turn()};
  if (c.below(8) == 1) def.largest_force = c.ratio(1, 1e4);
  def.collide = c.below(3) == 1;
  const std::uint32_t a = draw_body(c, host), b = draw_body(c, host);
  const bool open = c.below(4) == 1;
  return {"create_joint", [=](Host& h) {
            JointDef joined = def;
            joined.a = h.body(a);
            joined.b = h.body(b);
            const auto at = [&](BodyId id) { return h.world.valid(id) ? *h.world.pose(id) : Pose{}; };
            if (!open) {  // where the pin stands in a, it stands in b
              const Pose from = at(joined.a), to = at(joined.b);
              const Vec3 pin = transform(from, joined.frame_a.position);
              joined.frame_b.position = rotate(conjugate(to.orientation), pin - to.position);
            }
            return keep(h.joints, h.world.create_joint(joined));
          }};
}

Call make_spring(Choices& c, const Host& host) {
  SpringDef def;
  def.anchor_a = c.vector(0.3);
  def.anchor_b = c.vector(0.3);
  def.rest_length = c.number(0, 1);
  def.stiffness = c.ratio(1, 1e5);
  def.damping = c.below(2) ? c.ratio(0.1, 1e3) : 0;
  const std::uint32_t a = draw_body(c, host), b = draw_body(c, host);
  return {"create_spring", [=](Host& h) {
            SpringDef joined = def;
            joined.a = h.body(a);
            joined.b = h.body(b);
            return keep(h.springs, h.world.create_spring(joined));
          }};
}

Call make_ragdoll(Choices& c, const Theme& theme) {
  const Pose pose = draw_pose(c, theme);
  const Vec3 velocity = c.vector(3);
  return {"create_ragdoll", [=](Host& h) -> Outcome {
            const Result<Ragdoll> made = h.world.create_ragdoll(RagdollDef::human(), pose, velocity);
            if (!made) return {made.error().code, {}, made.error().message};
            h.bodies.insert(h.bodies.end(), made->bones.begin(), made->bones.end());
            h.joints.insert(h.joints.end(), made->joints.begin(), made->joints.end());
            return {};
          }};
}

Call grab(Choices& c, const Host& host) {
  const std::uint32_t hand = draw_body(c, host), body = draw_body(c, host);
  const Vec3 point = c.vector(1);
  return {"grab", [=](Host& h) { return keep(h.joints, h.world.grab(h.body(hand), h.body(body), point)); }};
}

Call destroy(Choices& c, const Host& host) {
  const std::uint32_t body = draw_body(c, host);
  const std::uint32_t joint = c.below(std::uint32_t(host.joints.size()) + 1),
                      spring = c.below(std::uint32_t(host.springs.size()) + 1);
  switch (c.below(4)) {
    case 0: return {"destroy joint", [=](Host& h) { return of(h.world.destroy(Host::at(h.joints, joint))); }};
    case 1: return {"destroy spring", [=](Host& h) { return of(h.world.destroy(Host::at(h.springs, spring))); }};
    default: return {"destroy body", [=](Host& h) { return of(h.world.destroy(h.body(body))); }};
  }
}

Call make_object(Choices& c, const Theme& theme, const Host& host) {
  if (host.world.body_count() >= theme.most_bodies) return destroy(c, host);
  const std::uint32_t what = c.below(20);
  if (what < 9) return make_body(c, theme);
  if (what < 13) return make_joint(c, host);
  if (what < 15) return make_spring(c, host);
  if (what == 15 && host.world.body_count() + 12 <= theme.most_bodies) return make_ragdoll(c, theme);
  if (what == 16) return grab(c, host);
  return destroy(c, host);
}

Call set_state(Choices& c, const Theme& theme, const Host& host) {
  const std::uint32_t body = draw_body(c, host);
  switch (c.below(8)) {
    case 0:
    case 1:
      return {"set_pose", [=, p = draw_pose(c, theme)](Host& h) { return of(h.world.set_pose(h.body(body), p)); }};
    case 2:
      return {"set_pose a little", [=, by = c.vector(0.01)](Host& h) {
                const Result<Pose> pose = h.world.pose(h.body(body));
                if (!pose) return of(pose.error());
                return of(h.world.set_pose(h.body(body), {pose->position + by, pose->orientation}));
              }};
    case 3:
    case 4:
      return {"set_velocity", [=, v = c.vector(5)](Host& h) { return of(h.world.set_velocity(h.body(body), v)); }};
    case 5:
      return {"set_angular_velocity",
              [=, w = c.vector(10)](Host& h) { return of(h.world.set_angular_velocity(h.body(body), w)); }};
    case 6:
      return {"set_position_last",
              [=, p = c.vector(theme.size)](Host& h) { return of(h.world.set_position_last(h.body(body), p)); }};
    default:
      return {"set_orientation_last",
              [=, q = c.turn()](Host& h) { return of(h.world.set_orientation_last(h.body(body), q)); }};
  }
}

Call set_input(Choices& c, const Host& host) {
  const std::uint32_t body = draw_body(c, host), other = draw_body(c, host);
  switch (c.below(8)) {
    case 0:
      return {"set_gravity", [g = c.below(4) ? c.vector(10) : Vec3{}](Host& h) { return of(h.world.set_gravity(g)); }};
    case 1: {
      const MassProperties m{c.ratio(0.01, 100), {c.ratio(0.1, 0.2), c.ratio(0.1, 0.2), c.ratio(0.1, 0.2)}};
      return {"set_mass_properties", [=](Host& h) { return of(h.world.set_mass_properties(h.body(body), m)); }};
    }
    case 2:
      return {"set_material", [=, m = draw_material(c)](Host& h) { return of(h.world.set_material(h.body(body), m)); }};
    case 3: {
      const double linear = c.number(0, 2), angular = c.number(0, 2);
      return {"set_drag", [=](Host& h) { return of(h.world.set_drag(h.body(body), linear, angular)); }};
    }
    case 4: {
      const Filter filter{c.below(4), c.below(4), int(c.below(3)) - 1};
      return {"set_filter", [=](Host& h) { return of(h.world.set_filter(h.body(body), filter)); }};
    }
    case 5:
      return {"set_collide", [=, collide = c.below(2) == 1](Host& h) {
                return of(h.world.set_collide(h.body(body), h.body(other), collide));
              }};
    case 6: return {"wake", [=](Host& h) { return of(h.world.wake(h.body(body))); }};
    default:
      return {"set_can_sleep",
              [=, can = c.below(2) == 1](Host& h) { return of(h.world.set_can_sleep(h.body(body), can)); }};
  }
}

Call set_drive(Choices& c, const Host& host) {
  const std::uint32_t joint = c.below(std::uint32_t(host.joints.size()) + 1),
                      spring = c.below(std::uint32_t(host.springs.size()) + 1);
  const double x = c.number(-5, 5), y = c.ratio(0.1, 100), z = c.below(2) ? 0 : c.ratio(0.1, 100);
  switch (c.below(3)) {
    case 0: return {"set_motor", [=](Host& h) { return of(h.world.set_motor(Host::at(h.joints, joint), {x, z})); }};
    case 1:
      return {"set_spring", [=](Host& h) { return of(h.world.set_spring(Host::at(h.joints, joint), {y, z, {}})); }};
    default:
      return {"set_spring of points",
              [=](Host& h) { return of(h.world.set_spring(Host::at(h.springs, spring), std::abs(x), y, z)); }};
  }
}

Call force(Choices& c, const Host& host) {
  const std::uint32_t body = draw_body(c, host), force = c.below(std::uint32_t(host.forces.size()) + 1);
  const Wrench wrench{c.vector(20), c.vector(2)};
  switch (c.below(4)) {
    case 0: return {"remove force", [=](Host& h) { return of(h.world.remove(Host::at(h.forces, force))); }};
    case 1:
      return {"add_force callback", [=](Host& h) {
                const auto steady = [wrench](const World& world, BodyId id) {
                  const Result<Pose> pose = world.pose(id);
                  return pose ? Wrench{wrench.force - 2.0 * pose->position, wrench.torque} : wrench;
                };
                return keep(h.forces, h.world.add_force(h.body(body), steady));
              }};
    default: return {"add_force", [=](Host& h) { return keep(h.forces, h.world.add_force(h.body(body), wrench)); }};
  }
}

StepSettings draw_settings(Choices& c, const Theme& theme) {
  StepSettings s;
  s.substeps = c.below(30) == 1 ? c.below(3) : 1 + c.below(5);
  s.order = c.below(5) == 1 ? 4 : 2;
  s.refinement = c.below(3) == 1 ? 1 : 16;
  s.integrator = Integrator(c.below(2));
  s.sleep = theme.sleep && c.below(6) != 1;
  s.sleep_time = c.ratio(0.01, 0.2);
  s.sleep_speed = c.ratio(0.02, 0.5);
  s.sleep_spin = c.ratio(0.02, 0.5);
  s.restitution_threshold = c.below(4) ? 0.5 : 0;
  s.contact_margin = c.below(6) == 1 ? c.number(0, 0.05) : 0;
  if (c.below(30) == 1) s.max_pairs = c.below(3);
  s.contact_events = s.hit_events = s.body_events = c.below(2) == 1;
  return s;
}

Call configure(Choices& c, const Theme& theme) {
  return {"configure", [s = draw_settings(c, theme)](Host& h) { return h.configure(s); }};
}

Call own(Choices& c, const Host& host) {
  const std::uint32_t body = draw_body(c, host), k = c.below(std::uint32_t(host.properties.size()) + 1);
  const double value = c.number(-10, 10);
  const std::string name = "own" + std::to_string(c.below(4));
  switch (c.below(4)) {
    case 0:
      return {"add_property", [=, role = Role(c.below(5))](Host& h) {
                return keep(h.properties, h.world.add_property<Real>(name, value, "1", body_table, role));
              }};
    case 1: return {"remove_property", [=](Host& h) { return of(h.world.remove_property(name)); }};
    default:
      return {"set property",
              [=](Host& h) { return of(h.world.set(Host::at(h.properties, k), h.body(body), Real(value))); }};
  }
}

Call save_or_restore(Choices& c) {
  if (c.below(2) == 1)
    return {"snapshot", [](Host& h) {
              h.saved = h.world.snapshot();
              return Outcome{};
            }};
  const std::uint32_t cut = c.below(4) == 1 ? c.below(1u << 16) : 0, how = c.below(3);
  return {"restore", [=](Host& h) {
            std::vector<std::byte> bytes = h.saved;
            if (cut > 0 && !bytes.empty() && how == 0) bytes.resize(cut % bytes.size());
            if (cut > 0 && !bytes.empty() && how == 1) bytes[cut % bytes.size()] ^= std::byte{1};
            return of(h.world.restore(bytes));
          }};
}

Call step(Choices& c) {
  const std::uint32_t kind = c.below(24);
  double dt = kind < 18 ? 1.0 / 60 : kind < 22 ? c.by_ratio(1.0 / 500, 1.0 / 20) : c.by_ratio(1e-12, 1e-2);
  if (c.below(60) == 1) dt = c.odd();
  return {"step", [=](Host& h) { return h.step(dt); }, true};
}

}  // namespace

Theme draw_theme(Choices& c) {
  Theme theme;
  theme.most_bodies = 2 + c.below(c.below(4) == 1 ? 40 : 10);
  theme.sleep = c.below(3) > 0;
  theme.size = c.by_ratio(0.5, 5);
  for (std::uint32_t& weight : theme.weights) weight = 1 + c.below(6);
  theme.weights[7] = 8 + c.below(60);  // steps
  return theme;
}

std::vector<Call> first_calls(Choices& c, const Theme& theme) {
  std::vector<Call> calls{configure(c, theme)};
  if (c.below(4) > 0) {
    BodyDef floor;
    floor.kind = BodyKind::fixed;
    floor.shapes = {c.below(2) ? ShapeDef::plane() : ShapeDef::box({4, 0.5, 4})};
    floor.pose.position = {0, -theme.size, 0};
    calls.push_back({"floor", [=](Host& h) { return keep(h.bodies, h.world.create_body(floor)); }});
  }
  for (std::uint32_t i = c.below(theme.most_bodies); i > 0; i--) calls.push_back(make_body(c, theme));
  return calls;
}

Call draw_call(Choices& c, const Theme& theme, const Host& host) {
  std::uint32_t sum = 0;
  for (const std::uint32_t weight : theme.weights) sum += weight;
  std::uint32_t at = c.below(sum), kind = 0;
  while (at >= theme.weights[kind]) at -= theme.weights[kind++];
  switch (kind) {
    case 0: return make_object(c, theme, host);
    case 1: return set_state(c, theme, host);
    case 2: return set_input(c, host);
    case 3: return c.below(2) ? set_drive(c, host) : force(c, host);
    case 4: return configure(c, theme);
    case 5: return own(c, host);
    case 6: return save_or_restore(c);
    default: return step(c);
  }
}

}  // namespace fuzz
