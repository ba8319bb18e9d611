// Bodies of a world: creating and destroying them.
#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_set>
#include <utility>

#include "world/invariants.h"
#include "world/state.h"
#include "world/validate.h"

namespace pcphys {
namespace {

std::uint32_t new_shape(WorldState& s, std::uint32_t body, const ShapeDef& def) {
  std::uint32_t index;
  if (s.free_shapes.empty()) {
    index = std::uint32_t(s.shapes.size());
    s.shapes.emplace_back();
    s.tables.resize(Table::shape, index + 2);
  } else {
    std::ranges::pop_heap(s.free_shapes, std::greater<>());
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
  if (state_ && state_->stepping)
    detail::misuse("A World was destroyed while a step of it runs; no callback may do that.");
  if (state_) walk_in_debug(*state_, "~World");
}
World::World(World&& other) noexcept {
  if (other.state_ && other.state().stepping)
    detail::misuse("A World was moved while a step of it runs; no callback may do that.");
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
  walk_in_debug(*state_, call);
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
  return caught();
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
  return caught();
}

namespace {
void forget_apart(WorldState& s, std::uint32_t index) {
  const auto asked = s.asked_apart.extract(index);
  if (!asked) return;
  for (const std::uint32_t other : asked.mapped()) {
    s.no_collide.erase(WorldState::pair_key(index, other));
    const auto of_other = s.asked_apart.find(other);
    if (of_other == s.asked_apart.end()) continue;
    std::erase(of_other->second, index);
    if (of_other->second.empty()) s.asked_apart.erase(of_other);
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
    std::ranges::push_heap(free_shapes, std::greater<>());
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
  return caught();
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
  return caught();
}
Result<std::uint32_t> World::row_of(JointId joint) const try {
  if (!valid(joint)) return stale("joint");
  return state().joint_ids.row(joint.index);
} catch (...) {
  return caught();
}
Result<bool> World::frozen(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().bodies[state().body_ids.row(body.index)].frozen;
} catch (...) {
  return caught();
}
Result<BodyKind> World::kind(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().bodies[state().body_ids.row(body.index)].kind;
} catch (...) {
  return caught();
}

}  // namespace pcphys
