// Bodies of a world: creating and destroying them, and what a host reads and writes of them.
#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_set>
#include <utility>

#include "world/state.h"
#include "world/validate.h"

namespace pcphys {
namespace {

void write_material(Tables& t, std::uint32_t row, const Material& m) {
  t.set(Buffer::material, row, 0, m.static_friction);
  t.set(Buffer::material, row, 1, m.kinetic_friction);
  t.set(Buffer::material, row, 2, m.restitution);
  t.set(Buffer::material, row, 3, double(m.friction_rule));
  t.set(Buffer::material, row, 4, m.rolling_friction);
  t.set(Buffer::material, row, 5, m.torsional_friction);
  t.set(Buffer::material, row, 6, double(m.restitution_rule));
}

std::uint32_t new_shape(WorldState& s, std::uint32_t body, const ShapeDef& def) {
  std::uint32_t index;
  if (s.free_shapes.empty()) {
    index = std::uint32_t(s.shapes.size());
    s.shapes.emplace_back();
    s.tables.resize(Table::shape, index + 2);
  } else {
    index = s.free_shapes.back();
    s.free_shapes.pop_back();
  }
  s.shapes[index] = {body, def.filter, def, true};
  const std::uint32_t row = index + 1;
  s.tables.set3(Buffer::shape, row, 0,
                def.kind == ShapeKind::hull ? Vec3{def.convex.radius(), def.convex.inner_radius(), 0} : def.size);
  s.tables.set(Buffer::shape, row, 3, double(def.kind));
  s.tables.set3(Buffer::shape, row, 4, def.local.position);
  s.tables.set4(Buffer::shape, row, 8, def.local.orientation);
  return index;
}

}  // namespace

World::World(const WorldDef& def) try : state_(std::make_unique<WorldState>(def)) {
} catch (...) {
  detail::no_memory_for("World");
}
World::~World() {
  if (state_ && state_->stepping) detail::misuse("A World was destroyed while a step of it runs; no callback may do that.");
}
World::World(World&& other) noexcept {
  if (other.state_ && other.state().stepping) detail::misuse("A World was moved while a step of it runs; no callback may do that.");
  state_ = std::move(other.state_);
}
World& World::operator=(World&& other) noexcept {
  World taken(std::move(other));
  World given(std::move(*this));
  state_ = std::move(taken.state_);
  return *this;
}

Status World::changeable(const char* call) const {
  if (state(call).stepping) return busy("world");
  return {};
}
Status World::changeable(BodyId body, const char* call) const {
  if (Status ok = changeable(call); !ok) return ok;
  if (!valid(body)) return stale("body");
  return {};
}
Status World::changeable(JointId joint, const char* call) const {
  if (Status ok = changeable(call); !ok) return ok;
  if (!valid(joint)) return stale("joint");
  return {};
}
Status World::changeable(SpringId spring, const char* call) const {
  if (Status ok = changeable(call); !ok) return ok;
  if (!valid(spring)) return stale("spring");
  return {};
}

BodyId World::ground() const { return state().body_ids.id<BodyId>(0); }
bool World::valid(BodyId body) const { return state().body_ids.valid(body); }
std::size_t World::body_count() const { return state().body_ids.count() - 1; }
Precision World::precision() const { return state().tables.precision(); }
Vec3 World::gravity() const { return state().gravity; }

Status World::set_gravity(Vec3 gravity) try {
  if (Status ok = changeable(); !ok) return ok;
  if (Status ok = check_finite(gravity, "gravity"); !ok) return ok;
  if (gravity == state().gravity) return {};
  for (std::uint32_t row = 1; row < state().bodies.size(); row++) {
    state().kick(row, gravity - state().gravity, {});
    state().stir(row);
  }
  state().gravity = gravity;
  return {};
} catch (...) {
  return no_memory();
}

Result<BodyId> World::create_body(const BodyDef& def) try {
  if (Status ok = changeable(); !ok) return ok.error();
  Quat orientation;
  const Result<MassProperties> mass = check(def, orientation);
  if (!mass) return mass.error();

  WorldState& s = state();
  s.make_room(1, 0, std::uint32_t(def.shapes.size()));
  BodyRecord body;
  body.kind = def.kind;
  body.shapes.reserve(def.shapes.size());
  // nothing needs memory from here on
  const std::uint32_t row = std::uint32_t(s.bodies.size()), index = s.body_ids.allocate(row);
  body.index = index;
  s.bodies.push_back(std::move(body));
  s.tables.resize(Table::body, row + 1);
  s.set_position(row, def.pose.position);
  s.set_orientation(row, orientation);
  if (def.kind == BodyKind::dynamic) s.set_mass(row, *mass);
  if (def.kind == BodyKind::kinematic) {
    s.tables.set3(Buffer::mass, row, 4, {1, 1, 1});
    s.kinematic++;
  }
  if (def.kind != BodyKind::fixed) {
    s.tables.set3(Buffer::motion, row, 0, def.velocity);
    s.set_angular_velocity(row, def.angular_velocity);
    s.bring_in_phase(row);
    s.let_settle(row);
  }
  write_material(s.tables, row, def.material);
  s.tables.set(Buffer::force, row, 3, def.linear_drag);
  s.tables.set(Buffer::force, row, 7, def.angular_drag);
  s.tables.set(Buffer::rest, row, rest_can_sleep, def.can_sleep);
  for (const ShapeDef& shape : def.shapes) s.bodies[row].shapes.push_back(new_shape(s, index, shape));
  s.structure_version++;
  s.stir(row);
  return s.body_ids.id<BodyId>(index);
} catch (...) {
  return no_memory();
}

namespace {
void forget_apart(WorldState& s, std::uint32_t index) {
  const auto asked = s.asked_apart.extract(index);
  if (!asked) return;
  for (const std::uint32_t other : asked.mapped()) {
    s.no_collide.erase(WorldState::pair_key(index, other));
    if (const auto of_other = s.asked_apart.find(other); of_other != s.asked_apart.end()) std::erase(of_other->second, index);
  }
}

}  // namespace

void WorldState::remove_body(std::uint32_t row) {
  const std::uint32_t index = bodies[row].index, last = std::uint32_t(bodies.size()) - 1;
  std::vector<std::uint32_t> of_body = std::move(bodies[row].joints);
  for (std::uint32_t& joint : of_body) joint = joint_ids.row(joint);
  std::ranges::sort(of_body, std::greater<>());
  for (const std::uint32_t joint : of_body) remove_joint(joint);
  if (bodies[row].kind == BodyKind::kinematic) kinematic--;
  for (const std::uint32_t force : bodies[row].forces) drop_force(force);
  for (const std::uint32_t shape : bodies[row].shapes) {
    shapes[shape].alive = false;
    shapes[shape].def.convex = {};  // the last user frees it
    free_shapes.push_back(shape);
  }
  forget_apart(*this, index);
  frozen.erase(index);
  forget_rest(row);
  if (contact_rows() > 1) drops.drop(row, last);
  remove_row(Table::body, bodies, body_ids, row);
}

Status World::destroy(BodyId body) { return destroy(std::span(&body, 1)); }

Status World::destroy(std::span<const BodyId> bodies) try {
  if (Status ok = changeable(); !ok) return ok;
  WorldState& s = state();
  std::unordered_set<std::uint32_t> seen;
  for (const BodyId body : bodies) {
    if (!valid(body) || (bodies.size() > 1 && !seen.insert(body.index).second)) return stale("body");
    if (body.index == 0) return Error{ErrorCode::bad_argument, "The ground cannot be destroyed."};
  }
  s.drops.make_room(bodies.size());
  for (const BodyId body : bodies) s.remove_body(s.body_ids.row(body.index));
  return {};
} catch (...) {
  return no_memory();
}

std::vector<BodyId> World::bodies() const try {
  std::vector<BodyId> ids;
  for (std::uint32_t i = 1; i < state().body_ids.size(); i++)
    if (state().body_ids.alive(i)) ids.push_back(state().body_ids.id<BodyId>(i));
  return ids;
} catch (...) {
  detail::no_memory_for("World::bodies");
}

Result<std::uint32_t> World::row_of(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().body_ids.row(body.index);
} catch (...) {
  return no_memory();
}
Result<std::uint32_t> World::row_of(JointId joint) const try {
  if (!valid(joint)) return stale("joint");
  return state().joint_ids.row(joint.index);
} catch (...) {
  return no_memory();
}
Result<bool> World::frozen(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().bodies[state().body_ids.row(body.index)].frozen;
} catch (...) {
  return no_memory();
}
Result<BodyKind> World::kind(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().bodies[state().body_ids.row(body.index)].kind;
} catch (...) {
  return no_memory();
}

// ---- state ---------------------------------------------------------------------------------------------

Result<Pose> World::pose(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().pose(state().body_ids.row(body.index));
} catch (...) {
  return no_memory();
}

Status World::set_pose(BodyId body, const Pose& pose) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (body.index == 0)
    return Error{ErrorCode::bad_argument, "The ground stays at the origin; create a fixed body for anything else."};
  Quat q = pose.orientation;
  if (Status ok = check_finite(pose.position, "position of a body"); !ok) return ok;
  if (Status ok = check_unit(q, "orientation of a body"); !ok) return ok;
  WorldState& s = state();
  const std::uint32_t row = s.body_ids.row(body.index);
  const bool spins = s.bodies[row].kind == BodyKind::dynamic && !(q == s.orientation(row));
  const Vec3 w = s.angular_velocity(row);
  if (Status ok = spins ? check_spin(mass_properties(body)->moments, w) : Status{}; !ok) return ok;
  s.change(row);
  s.set_position(row, pose.position);
  s.set_orientation(row, q);
  if (spins) {  // the angular velocity stays, so the momentum changes
    s.bring_in_phase(row);
    s.set_angular_velocity(row, w);
  }
  s.let_settle(row);
  return {};
} catch (...) {
  return no_memory();
}

Result<Vec3> World::velocity(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().velocity(state().body_ids.row(body.index));
} catch (...) {
  return no_memory();
}

Status World::set_velocity(BodyId body, Vec3 velocity) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = check_finite(velocity, "velocity of a body"); !ok) return ok;
  const std::uint32_t row = state().body_ids.row(body.index);
  if (state().bodies[row].kind == BodyKind::fixed)
    return Error{ErrorCode::bad_argument, "A fixed body has no velocity; make it kinematic to move it."};
  state().change(row);
  state().bring_in_phase(row);
  state().tables.set3(Buffer::motion, row, 0, velocity);
  return {};
} catch (...) {
  return no_memory();
}

Result<Vec3> World::angular_velocity(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().angular_velocity(state().body_ids.row(body.index));
} catch (...) {
  return no_memory();
}

Status World::set_angular_velocity(BodyId body, Vec3 w) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = check_finite(w, "angular velocity of a body"); !ok) return ok;
  const std::uint32_t row = state().body_ids.row(body.index);
  if (state().bodies[row].kind == BodyKind::fixed)
    return Error{ErrorCode::bad_argument, "A fixed body has no angular velocity; make it kinematic to turn it."};
  if (!state().rotates(row) && w != Vec3{}) return no_rotation();
  if (Status ok = check_spin(mass_properties(body)->moments, w); !ok) return ok;
  state().change(row);
  state().bring_in_phase(row);
  state().set_angular_velocity(row, w);
  return {};
} catch (...) {
  return no_memory();
}

Result<Vec3> World::angular_momentum(BodyId body) const try {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state().body_ids.row(body.index);
  return state().bodies[row].kind == BodyKind::dynamic ? state().momentum_of_rotation(row) : Vec3{};
} catch (...) {
  return no_memory();
}

namespace {
Status need_substep(const WorldState& s) {
  if (s.last_substep > 0) return {};
  return Error{ErrorCode::bad_time_step,
               "Last positions are one sub-step ago, and no step has been made yet; set a velocity instead."};
}
}  // namespace

Result<Vec3> World::position_last(BodyId body) const try {
  if (!valid(body)) return stale("body");
  if (Status ok = need_substep(state()); !ok) return ok.error();
  const std::uint32_t row = state().body_ids.row(body.index);
  return state().pose(row).position - state().last_substep * state().tables.get3(Buffer::motion, row, 0);
} catch (...) {
  return no_memory();
}

Status World::set_position_last(BodyId body, Vec3 position) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = need_substep(state()); !ok) return ok;
  if (Status ok = check_finite(position, "last position of a body"); !ok) return ok;
  WorldState& s = state();
  const std::uint32_t row = s.body_ids.row(body.index);
  if (s.bodies[row].kind == BodyKind::fixed)
    return Error{ErrorCode::bad_argument, "A fixed body has no last position; make it kinematic to move it."};
  const Vec3 v = (1 / s.last_substep) * (s.pose(row).position - position);
  if (Status ok = check_finite(v, "velocity that a body's last position stands for"); !ok) return ok;
  s.change(row);
  s.tables.set3(Buffer::motion, row, 0, v);
  for (std::uint32_t part : {0, 8}) s.tables.set3(Buffer::velocity_parts, row, part, {});
  if (s.tables.get(Buffer::motion, row, 7) < 0) s.tables.set(Buffer::motion, row, 7, 0);
  return {};
} catch (...) {
  return no_memory();
}

Result<Quat> World::orientation_last(BodyId body) const try {
  if (!valid(body)) return stale("body");
  if (Status ok = need_substep(state()); !ok) return ok.error();
  const std::uint32_t row = state().body_ids.row(body.index);
  const Quat q = state().orientation(row);
  const Vec3 pi = rotate(conjugate(q), state().tables.get3(Buffer::motion, row, 4)),
             i = state().tables.get3(Buffer::mass, row, 4);
  const Vec3 w = rotate(q, {i.x * pi.x, i.y * pi.y, i.z * pi.z});
  const double speed = length(w);
  if (speed == 0) return q;
  return axis_angle((1 / speed) * w, -speed * state().last_substep) * q;
} catch (...) {
  return no_memory();
}

Status World::set_orientation_last(BodyId body, Quat last) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = need_substep(state()); !ok) return ok;
  if (Status ok = check_unit(last, "last orientation of a body"); !ok) return ok;
  WorldState& s = state();
  const std::uint32_t row = s.body_ids.row(body.index);
  if (s.bodies[row].kind == BodyKind::fixed)
    return Error{ErrorCode::bad_argument, "A fixed body has no last orientation; make it kinematic to turn it."};
  if (!s.rotates(row)) return no_rotation();
  // 2 log of the world difference, taken on the near side of the double cover (errata iii.4 of the method)
  Quat d = s.orientation(row) * conjugate(last);
  if (d.w < 0) d = {-d.x, -d.y, -d.z, -d.w};
  const double sine = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), angle = 2 * std::atan2(sine, d.w);
  const double rate = sine > 0 ? angle / (sine * s.last_substep) : 0;
  const Vec3 w{rate * d.x, rate * d.y, rate * d.z};
  Status ok = check_finite(w, "angular velocity that a body's last orientation stands for");
  if (ok) ok = check_spin(mass_properties(body)->moments, w);
  if (!ok) return ok;
  s.change(row);
  s.set_angular_velocity(row, w);
  for (std::uint32_t part : {4, 12}) s.tables.set3(Buffer::velocity_parts, row, part, {});
  if (s.tables.get(Buffer::motion, row, 7) < 0) s.tables.set(Buffer::motion, row, 7, 0);
  return {};
} catch (...) {
  return no_memory();
}

// ---- inputs --------------------------------------------------------------------------------------------

Result<MassProperties> World::mass_properties(BodyId body) const try {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state().body_ids.row(body.index);
  if (state().bodies[row].frozen) return state().frozen.at(body.index);
  return MassProperties{state().tables.get(Buffer::mass, row, 3), state().tables.get3(Buffer::mass, row, 0)};
} catch (...) {
  return no_memory();
}

Status World::set_mass_properties(BodyId body, const MassProperties& mass) try {
  if (Status ok = changeable(body); !ok) return ok;
  WorldState& s = state();
  const std::uint32_t row = s.body_ids.row(body.index);
  const bool rotates = s.rotates(row);
  if (Status ok = check(mass, rotates); !ok) return ok;
  if (s.bodies[row].kind != BodyKind::dynamic) return Error{ErrorCode::bad_argument, "Only dynamic bodies have a mass."};
  const Vec3 w = s.angular_velocity(row), moments = rotates ? mass.moments : Vec3{};
  if (Status ok = check_spin(moments, w); !ok) return ok;
  s.change(row);
  s.set_mass(row, {mass.mass, moments});
  s.structure_version++;
  s.bring_in_phase(row);
  s.set_angular_velocity(row, w);
  return {};
} catch (...) {
  return no_memory();
}

Result<Material> World::material(BodyId body) const try {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state().body_ids.row(body.index);
  const Tables& t = state().tables;
  const auto get = [&](std::uint32_t k) { return t.get(Buffer::material, row, k); };
  return Material{get(0), get(1), get(2), get(4), get(5), Combine(std::uint8_t(get(3))), Combine(std::uint8_t(get(6)))};
} catch (...) {
  return no_memory();
}

Status World::set_material(BodyId body, const Material& material) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = check(material); !ok) return ok;
  const std::uint32_t row = state().body_ids.row(body.index);
  write_material(state().tables, row, material);
  state().stir(row);
  return {};
} catch (...) {
  return no_memory();
}

Status World::set_drag(BodyId body, double linear, double angular) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = check_finite(linear, "linear drag of a body"); !ok) return ok;
  if (Status ok = check_finite(angular, "angular drag of a body"); !ok) return ok;
  if (linear < 0 || angular < 0) return Error{ErrorCode::bad_argument, "A drag is below zero; use 0 for none."};
  const std::uint32_t row = state().body_ids.row(body.index);
  state().change(row);
  state().bring_in_phase(row);
  state().tables.set(Buffer::force, row, 3, linear);
  state().tables.set(Buffer::force, row, 7, angular);
  state().structure_version++;  // the plan leaves drag out where there is none
  return {};
} catch (...) {
  return no_memory();
}

Result<std::vector<ShapeDef>> World::shapes(BodyId body) const try {
  if (!valid(body)) return stale("body");
  std::vector<ShapeDef> defs;
  for (std::uint32_t shape : state().bodies[state().body_ids.row(body.index)].shapes) defs.push_back(state().shapes[shape].def);
  return defs;
} catch (...) {
  return no_memory();
}

Status World::set_filter(BodyId body, const Filter& filter) try {
  if (Status ok = changeable(body); !ok) return ok;
  for (std::uint32_t shape : state().bodies[state().body_ids.row(body.index)].shapes)
    state().shapes[shape].filter = state().shapes[shape].def.filter = filter;
  state().structure_version++;
  state().stir(state().body_ids.row(body.index));
  return {};
} catch (...) {
  return no_memory();
}

Status World::set_collide(BodyId a, BodyId b, bool collide) try {
  Status ok = changeable(a);
  if (ok) ok = changeable(b);
  if (!ok) return ok;
  WorldState& s = state();
  for (const BodyId body : {a, b}) make_room(s.asked_apart[body.index], 2);
  const auto pair = s.no_collide.try_emplace(WorldState::pair_key(a.index, b.index)).first;
  for (const auto& [body, other] : {std::pair(a.index, b.index), std::pair(b.index, a.index)}) {
    std::vector<std::uint32_t>& others = s.asked_apart[body];
    if (pair->second.asked == collide) collide ? void(std::erase(others, other)) : others.push_back(other);
    if (others.empty()) s.asked_apart.erase(body);
  }
  pair->second.asked = !collide;
  if (!pair->second.any()) s.no_collide.erase(pair);
  state().structure_version++;
  state().stir_moving(state().body_ids.row(a.index));
  state().stir_moving(state().body_ids.row(b.index));
  return {};
} catch (...) {
  return no_memory();
}

}  // namespace pcphys
