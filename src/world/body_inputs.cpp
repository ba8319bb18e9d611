// What a host gives to a body: mass, material, drag, and what it collides with.
#include <utility>

#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

void write_material(Tables& t, std::uint32_t row, const Material& m) {
  t.set(Buffer::material, row, 0, m.static_friction);
  t.set(Buffer::material, row, 1, m.kinetic_friction);
  t.set(Buffer::material, row, 2, m.restitution);
  t.set(Buffer::material, row, 3, double(m.friction_rule));
  t.set(Buffer::material, row, 4, m.rolling_friction);
  t.set(Buffer::material, row, 5, m.torsional_friction);
  t.set(Buffer::material, row, 6, double(m.restitution_rule));
}

Result<MassProperties> World::mass_properties(BodyId body) const try {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state().body_ids.row(body.index);
  if (state().bodies[row].frozen) return state().frozen.at(body.index);
  return MassProperties{state().tables.get(Buffer::mass, row, 3), state().tables.get3(Buffer::mass, row, 0)};
} catch (...) {
  return caught();
}

Status World::set_mass_properties(BodyId body, const MassProperties& mass) try {
  if (Status ok = changeable(body); !ok) return ok;
  WorldState& s = state();
  const std::uint32_t row = s.body_ids.row(body.index);
  const bool rotates = s.rotates(row);
  if (Status ok = check(mass, rotates); !ok) return ok;
  if (s.bodies[row].kind != BodyKind::dynamic)
    return Error{ErrorCode::bad_argument, "Only dynamic bodies have a mass."};
  const Vec3 w = s.angular_velocity(row), moments = rotates ? mass.moments : Vec3{};
  if (Status ok = check_spin(moments, w); !ok) return ok;
  s.change(row);
  s.set_mass(row, {mass.mass, moments});
  s.structure_version++;
  s.bring_in_phase(row);
  s.set_angular_velocity(row, w);
  return {};
} catch (...) {
  return caught();
}

Result<Material> World::material(BodyId body) const try {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state().body_ids.row(body.index);
  const Tables& t = state().tables;
  const auto get = [&](std::uint32_t k) { return t.get(Buffer::material, row, k); };
  return Material{get(0), get(1), get(2), get(4), get(5), Combine(std::uint8_t(get(3))), Combine(std::uint8_t(get(6)))};
} catch (...) {
  return caught();
}

Status World::set_material(BodyId body, const Material& material) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = check(material); !ok) return ok;
  const std::uint32_t row = state().body_ids.row(body.index);
  write_material(state().tables, row, material);
  state().stir(row);
  return {};
} catch (...) {
  return caught();
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
  return caught();
}

Result<std::vector<ShapeDef>> World::shapes(BodyId body) const try {
  if (!valid(body)) return stale("body");
  std::vector<ShapeDef> defs;
  for (std::uint32_t shape : state().bodies[state().body_ids.row(body.index)].shapes)
    defs.push_back(state().shapes[shape].def);
  return defs;
} catch (...) {
  return caught();
}

Status World::set_filter(BodyId body, const Filter& filter) try {
  if (Status ok = changeable(body); !ok) return ok;
  for (std::uint32_t shape : state().bodies[state().body_ids.row(body.index)].shapes)
    state().shapes[shape].filter = state().shapes[shape].def.filter = filter;
  state().structure_version++;
  state().stir(state().body_ids.row(body.index));
  return {};
} catch (...) {
  return caught();
}

namespace {
/// A list of nobody is none.
void drop_if_empty(WorldState& s, std::uint32_t body) {
  const auto others = s.asked_apart.find(body);
  if (others != s.asked_apart.end() && others->second.empty()) s.asked_apart.erase(others);
}
}  // namespace

Status World::set_collide(BodyId a, BodyId b, bool collide) try {
  Status ok = changeable(a);
  if (ok) ok = changeable(b);
  if (ok && a == b)
    ok = Error{ErrorCode::bad_argument, "A body never collides with itself; set_collide needs two different bodies."};
  if (!ok) return ok;
  WorldState& s = state();
  for (const BodyId body : {a, b}) make_room(s.asked_apart[body.index], 2);
  // nothing needs memory behind the next line
  const auto pair = s.no_collide.try_emplace(WorldState::pair_key(a.index, b.index)).first;
  for (const auto& [body, other] : {std::pair(a.index, b.index), std::pair(b.index, a.index)}) {
    std::vector<std::uint32_t>& others = s.asked_apart.at(body);
    if (pair->second.asked == collide) collide ? void(std::erase(others, other)) : others.push_back(other);
  }
  for (const BodyId body : {a, b}) drop_if_empty(s, body.index);
  pair->second.asked = !collide;
  if (!pair->second.any()) s.no_collide.erase(pair);
  state().structure_version++;
  state().stir_moving(state().body_ids.row(a.index));
  state().stir_moving(state().body_ids.row(b.index));
  return {};
} catch (...) {
  for (const BodyId body : {a, b}) drop_if_empty(state(), body.index);
  return caught();
}

}  // namespace pcphys
