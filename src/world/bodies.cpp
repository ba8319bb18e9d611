// Bodies of a world: creating and destroying them, and what a host reads and writes of them.
#include <cmath>

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

World::World(const WorldDef& def) : state_(std::make_unique<WorldState>(def)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

BodyId World::ground() const { return state_->body_ids.id<BodyId>(0); }
bool World::valid(BodyId body) const { return state_->body_ids.valid(body); }
std::size_t World::body_count() const { return state_->body_ids.count() - 1; }
Precision World::precision() const { return state_->tables.precision(); }
Vec3 World::gravity() const { return state_->gravity; }

Status World::set_gravity(Vec3 gravity) {
  if (Status ok = check_finite(gravity, "gravity"); !ok) return ok;
  if (gravity == state_->gravity) return {};
  for (std::uint32_t row = 1; row < state_->bodies.size(); row++) {
    state_->kick(row, gravity - state_->gravity, {});
    state_->stir(row);
  }
  state_->gravity = gravity;
  return {};
}

Result<BodyId> World::create_body(const BodyDef& def) {
  Quat orientation;
  const Result<MassProperties> mass = check(def, orientation);
  if (!mass) return mass.error();

  WorldState& s = *state_;
  const std::uint32_t row = std::uint32_t(s.bodies.size());
  const std::uint32_t index = s.body_ids.allocate(row);
  s.bodies.push_back({index, def.kind, false, {}, {}});
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
}

Status World::destroy(BodyId body) {
  WorldState& s = *state_;
  if (!s.body_ids.valid(body)) return stale("body");
  if (body.index == 0) return Error{ErrorCode::bad_argument, "The ground cannot be destroyed."};
  s.stir_neighbours(s.body_ids.row(body.index));
  for (std::uint32_t row = std::uint32_t(s.joints.size()) - 1; row > 0; row--)
    if (s.joints[row].body_a == body.index || s.joints[row].body_b == body.index) s.remove_joint(row);
  const std::uint32_t row = s.body_ids.row(body.index), last = std::uint32_t(s.bodies.size()) - 1;
  if (s.bodies[row].kind == BodyKind::kinematic) s.kinematic--;
  for (std::uint32_t force : s.bodies[row].forces) s.drop_force(force);
  for (std::uint32_t shape : s.bodies[row].shapes) {
    s.shapes[shape].alive = false;
    s.shapes[shape].def.convex = {};  // the last user frees it
    s.free_shapes.push_back(shape);
  }
  std::erase_if(s.no_collide,
                [&](const auto& pair) { return pair.first >> 32 == body.index || (pair.first & 0xffffffffu) == body.index; });
  s.frozen.erase(body.index);
  s.drop_contacts(row, last);
  s.remove_row(Table::body, s.bodies, s.body_ids, row);
  if (s.rests) s.count_rest();
  return {};
}

std::vector<BodyId> World::bodies() const {
  std::vector<BodyId> ids;
  for (std::uint32_t i = 1; i < state_->body_ids.size(); i++)
    if (state_->body_ids.alive(i)) ids.push_back(state_->body_ids.id<BodyId>(i));
  return ids;
}

Result<std::uint32_t> World::row_of(BodyId body) const {
  if (!valid(body)) return stale("body");
  return state_->body_ids.row(body.index);
}
Result<std::uint32_t> World::row_of(JointId joint) const {
  if (!valid(joint)) return stale("joint");
  return state_->joint_ids.row(joint.index);
}
Result<bool> World::frozen(BodyId body) const {
  if (!valid(body)) return stale("body");
  return state_->bodies[state_->body_ids.row(body.index)].frozen;
}
Result<BodyKind> World::kind(BodyId body) const {
  if (!valid(body)) return stale("body");
  return state_->bodies[state_->body_ids.row(body.index)].kind;
}

// ---- state ---------------------------------------------------------------------------------------------

Result<Pose> World::pose(BodyId body) const {
  if (!valid(body)) return stale("body");
  return state_->pose(state_->body_ids.row(body.index));
}

Status World::set_pose(BodyId body, const Pose& pose) {
  if (!valid(body)) return stale("body");
  if (body.index == 0)
    return Error{ErrorCode::bad_argument, "The ground stays at the origin; create a fixed body for anything else."};
  Quat q = pose.orientation;
  if (Status ok = check_finite(pose.position, "position of a body"); !ok) return ok;
  if (Status ok = check_unit(q, "orientation of a body"); !ok) return ok;
  WorldState& s = *state_;
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
}

Result<Vec3> World::velocity(BodyId body) const {
  if (!valid(body)) return stale("body");
  return state_->velocity(state_->body_ids.row(body.index));
}

Status World::set_velocity(BodyId body, Vec3 velocity) {
  if (!valid(body)) return stale("body");
  if (Status ok = check_finite(velocity, "velocity of a body"); !ok) return ok;
  const std::uint32_t row = state_->body_ids.row(body.index);
  if (state_->bodies[row].kind == BodyKind::fixed)
    return Error{ErrorCode::bad_argument, "A fixed body has no velocity; make it kinematic to move it."};
  state_->change(row);
  state_->bring_in_phase(row);
  state_->tables.set3(Buffer::motion, row, 0, velocity);
  return {};
}

Result<Vec3> World::angular_velocity(BodyId body) const {
  if (!valid(body)) return stale("body");
  return state_->angular_velocity(state_->body_ids.row(body.index));
}

Status World::set_angular_velocity(BodyId body, Vec3 w) {
  if (!valid(body)) return stale("body");
  if (Status ok = check_finite(w, "angular velocity of a body"); !ok) return ok;
  const std::uint32_t row = state_->body_ids.row(body.index);
  if (state_->bodies[row].kind == BodyKind::fixed)
    return Error{ErrorCode::bad_argument, "A fixed body has no angular velocity; make it kinematic to turn it."};
  if (!state_->rotates(row) && w != Vec3{}) return no_rotation();
  if (Status ok = check_spin(mass_properties(body)->moments, w); !ok) return ok;
  state_->change(row);
  state_->bring_in_phase(row);
  state_->set_angular_velocity(row, w);
  return {};
}

Result<Vec3> World::angular_momentum(BodyId body) const {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state_->body_ids.row(body.index);
  return state_->bodies[row].kind == BodyKind::dynamic ? state_->momentum_of_rotation(row) : Vec3{};
}

namespace {
Status need_substep(const WorldState& s) {
  if (s.last_substep > 0) return {};
  return Error{ErrorCode::bad_time_step,
               "Last positions are one sub-step ago, and no step has been made yet; set a velocity instead."};
}
}  // namespace

Result<Vec3> World::position_last(BodyId body) const {
  if (!valid(body)) return stale("body");
  if (Status ok = need_substep(*state_); !ok) return ok.error();
  const std::uint32_t row = state_->body_ids.row(body.index);
  return state_->pose(row).position - state_->last_substep * state_->tables.get3(Buffer::motion, row, 0);
}

Status World::set_position_last(BodyId body, Vec3 position) {
  if (!valid(body)) return stale("body");
  if (Status ok = need_substep(*state_); !ok) return ok;
  if (Status ok = check_finite(position, "last position of a body"); !ok) return ok;
  WorldState& s = *state_;
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
}

Result<Quat> World::orientation_last(BodyId body) const {
  if (!valid(body)) return stale("body");
  if (Status ok = need_substep(*state_); !ok) return ok.error();
  const std::uint32_t row = state_->body_ids.row(body.index);
  const Quat q = state_->orientation(row);
  const Vec3 pi = rotate(conjugate(q), state_->tables.get3(Buffer::motion, row, 4)),
             i = state_->tables.get3(Buffer::mass, row, 4);
  const Vec3 w = rotate(q, {i.x * pi.x, i.y * pi.y, i.z * pi.z});
  const double speed = length(w);
  if (speed == 0) return q;
  return axis_angle((1 / speed) * w, -speed * state_->last_substep) * q;
}

Status World::set_orientation_last(BodyId body, Quat last) {
  if (!valid(body)) return stale("body");
  if (Status ok = need_substep(*state_); !ok) return ok;
  if (Status ok = check_unit(last, "last orientation of a body"); !ok) return ok;
  WorldState& s = *state_;
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
}

// ---- inputs --------------------------------------------------------------------------------------------

Result<MassProperties> World::mass_properties(BodyId body) const {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state_->body_ids.row(body.index);
  if (state_->bodies[row].frozen) return state_->frozen.at(body.index);
  return MassProperties{state_->tables.get(Buffer::mass, row, 3), state_->tables.get3(Buffer::mass, row, 0)};
}

Status World::set_mass_properties(BodyId body, const MassProperties& mass) {
  if (!valid(body)) return stale("body");
  WorldState& s = *state_;
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
}

Result<Material> World::material(BodyId body) const {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state_->body_ids.row(body.index);
  const Tables& t = state_->tables;
  const auto get = [&](std::uint32_t k) { return t.get(Buffer::material, row, k); };
  return Material{get(0), get(1), get(2), get(4), get(5), Combine(std::uint8_t(get(3))), Combine(std::uint8_t(get(6)))};
}

Status World::set_material(BodyId body, const Material& material) {
  if (!valid(body)) return stale("body");
  if (Status ok = check(material); !ok) return ok;
  const std::uint32_t row = state_->body_ids.row(body.index);
  write_material(state_->tables, row, material);
  state_->stir(row);
  return {};
}

Status World::set_drag(BodyId body, double linear, double angular) {
  if (!valid(body)) return stale("body");
  if (Status ok = check_finite(linear, "linear drag of a body"); !ok) return ok;
  if (Status ok = check_finite(angular, "angular drag of a body"); !ok) return ok;
  if (linear < 0 || angular < 0) return Error{ErrorCode::bad_argument, "A drag is below zero; use 0 for none."};
  const std::uint32_t row = state_->body_ids.row(body.index);
  state_->change(row);
  state_->bring_in_phase(row);
  state_->tables.set(Buffer::force, row, 3, linear);
  state_->tables.set(Buffer::force, row, 7, angular);
  state_->structure_version++;  // the plan leaves drag out where there is none
  return {};
}

Result<std::vector<ShapeDef>> World::shapes(BodyId body) const {
  if (!valid(body)) return stale("body");
  std::vector<ShapeDef> defs;
  for (std::uint32_t shape : state_->bodies[state_->body_ids.row(body.index)].shapes) defs.push_back(state_->shapes[shape].def);
  return defs;
}

Status World::set_filter(BodyId body, const Filter& filter) {
  if (!valid(body)) return stale("body");
  for (std::uint32_t shape : state_->bodies[state_->body_ids.row(body.index)].shapes)
    state_->shapes[shape].filter = state_->shapes[shape].def.filter = filter;
  state_->structure_version++;
  state_->stir(state_->body_ids.row(body.index));
  return {};
}

Status World::set_collide(BodyId a, BodyId b, bool collide) {
  if (!valid(a) || !valid(b)) return stale("body");
  const auto pair = state_->no_collide.try_emplace(WorldState::pair_key(a.index, b.index)).first;
  pair->second.asked = !collide;
  if (!pair->second.any()) state_->no_collide.erase(pair);
  state_->structure_version++;
  state_->stir_moving(state_->body_ids.row(a.index));
  state_->stir_moving(state_->body_ids.row(b.index));
  return {};
}

}  // namespace pcphys
