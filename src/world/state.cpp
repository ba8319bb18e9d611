#include "world/state.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "pcphys/constants.h"

namespace pcphys {

namespace {
std::atomic<std::uint64_t> worlds_made{0};

/// What an acceleration of 1 shifts the stored velocity by, with linear drag: h (phi2 - phi) / e of
/// kernels/begin.inl, -h / 2 without.
double half_kick(double drag, double h) {
  const double x = drag * h, e = std::exp(-std::min(x, 60.0));  // as the kernels have it
  if (x > 0.1) {
    const double phi = (1 - e) / x, phi2 = (1 - phi) / x;
    return h * (phi2 - phi) / e;
  }
  double sum = 0, term = 1;  // (-x)^k / k!
  for (int k = 0; k < 12; k++) {
    sum -= term / (k + 2);
    term *= -x / (k + 1);
  }
  return h * sum / e;
}
}  // namespace

WorldState::WorldState(const WorldDef& def) : serial(++worlds_made), tables(def.precision), gravity(def.gravity) {
  // the ground: id index 0, row 0
  body_ids.allocate(0);
  bodies.push_back({});
  joints.emplace_back();
  contacts.keys.resize(1);
  contacts.ends.resize(1);
  contacts.features.resize(1);
}

Pose WorldState::pose(std::uint32_t row) const {
  return {tables.get3(Buffer::pose, row, 0) + tables.get3(Buffer::pose, row, 8), orientation(row)};
}

void WorldState::set_position(std::uint32_t row, Vec3 position) {
  tables.set3(Buffer::pose, row, 0, position);
  tables.set3(Buffer::pose, row, 8, position - tables.get3(Buffer::pose, row, 0));
}

Quat WorldState::orientation(std::uint32_t row) const {
  const Quat q = tables.get4(Buffer::pose, row, 4), low = tables.get4(Buffer::pose, row, 12);
  return {q.x + low.x, q.y + low.y, q.z + low.z, q.w + low.w};
}

void WorldState::set_orientation(std::uint32_t row, Quat q) {
  tables.set4(Buffer::pose, row, 4, q);
  const Quat high = tables.get4(Buffer::pose, row, 4);
  tables.set4(Buffer::pose, row, 12, {q.x - high.x, q.y - high.y, q.z - high.z, q.w - high.w});
}

Vec3 WorldState::velocity(std::uint32_t row) const {
  return tables.get3(Buffer::motion, row, 0) + tables.get3(Buffer::velocity_parts, row, 0);
}

Vec3 WorldState::momentum_of_rotation(std::uint32_t row) const {
  return tables.get3(Buffer::motion, row, 4) + tables.get3(Buffer::velocity_parts, row, 4);
}

Vec3 WorldState::angular_velocity(std::uint32_t row) const { return spin_of(row, momentum_of_rotation(row)); }

double WorldState::size(std::uint32_t row) const {
  const Vec3 moments = tables.get3(Buffer::mass, row, 0);
  return 2 * std::sqrt(std::max({moments.x, moments.y, moments.z}) * tables.get(Buffer::motion, row, 3));
}

Vec3 WorldState::spin_of(std::uint32_t row, Vec3 angular_momentum) const {
  const Quat q = orientation(row);
  const Vec3 pi = rotate(conjugate(q), angular_momentum), i = tables.get3(Buffer::mass, row, 4);
  return rotate(q, {i.x * pi.x, i.y * pi.y, i.z * pi.z});
}

void WorldState::bring_in_phase(std::uint32_t row) {
  if (bodies[row].kind != BodyKind::dynamic) return;
  const Vec3 v = velocity(row), l = momentum_of_rotation(row);
  tables.set3(Buffer::motion, row, 0, v);
  tables.set3(Buffer::motion, row, 4, l);
  tables.set(Buffer::motion, row, 7, -1);
  for (std::uint32_t part = 0; part < 16; part += 4) tables.set3(Buffer::velocity_parts, row, part, {});
}

void WorldState::let_settle(std::uint32_t row) {
  if (bodies[row].kind != BodyKind::dynamic) return;
  tables.set(Buffer::velocity_parts, row, place::settling, constants::rounds);
  settling = constants::rounds;
}

void WorldState::stir(std::uint32_t row) {
  if (!rests) return;
  tables.set(Buffer::rest, row, rest_quiet_time, 0);
  if (sleepers == 0 || goes(row) || tables.get(Buffer::rest, row, rest_stirred) > 0) return;
  tables.set(Buffer::rest, row, rest_stirred, 1);
  stirred++;
  rest_version++;
}

void WorldState::stir_all() {
  for (std::uint32_t row = 1; rests && row < bodies.size(); row++) stir_moving(row);
}

void WorldState::stir_reader(Table table, std::uint32_t row) {
  if (std::ranges::all_of(kernel_holds, [](const auto& hold) { return hold.expired(); })) return;  // nobody reads it
  if (table == Table::body) {
    stir(row);
  } else if (table == Table::joint) {
    stir_moving(body_ids.row(joints[row].body_a));
    stir_moving(body_ids.row(joints[row].body_b));
  } else if (tables.rows(table) == 2) {
    stir_all();
  }
}

void WorldState::forget_rest(std::uint32_t row) {
  const bool sleeps = tables.get(Buffer::rest, row, rest_asleep) > 0,
             stirs = tables.get(Buffer::rest, row, rest_stirred) > 0;
  sleepers -= sleeps;
  stirred -= stirs;
  if (sleeps || stirs) rest_version++;
}

void WorldState::forget_rest() {
  for (std::uint32_t row = 0; row < bodies.size(); row++)
    for (const RestField field : {rest_quiet_time, rest_asleep, rest_stirred}) tables.set(Buffer::rest, row, field, 0);
  sleepers = stirred = 0;
  rests = false;
  rest_version++;
}

void WorldState::calm() {
  for (std::uint32_t row = 0; row < bodies.size(); row++) tables.set(Buffer::rest, row, rest_stirred, 0);
  count_rest();
}

void WorldState::count_rest() {
  const bool some_before = sleepers > 0 || stirred > 0;
  sleepers = stirred = 0;
  rests = false;
  for (std::uint32_t row = 0; row < bodies.size(); row++) {
    sleepers += tables.get(Buffer::rest, row, rest_asleep) > 0;
    stirred += tables.get(Buffer::rest, row, rest_stirred) > 0;
    rests |= !never_rested(row);
  }
  if (some_before || sleepers > 0 || stirred > 0) rest_version++;
}

void WorldState::set_angular_velocity(std::uint32_t row, Vec3 w) {
  if (bodies[row].kind == BodyKind::kinematic) {
    tables.set3(Buffer::motion, row, 4, w);
    return;
  }
  const Quat q = orientation(row);
  const Vec3 local = rotate(conjugate(q), w), i = tables.get3(Buffer::mass, row, 0);
  tables.set3(Buffer::motion, row, 4, rotate(q, {i.x * local.x, i.y * local.y, i.z * local.z}));
}

void WorldState::set_mass(std::uint32_t row, const MassProperties& m) {
  const Vec3 i = m.moments;
  tables.set3(Buffer::mass, row, 0, i);
  tables.set(Buffer::mass, row, 3, m.mass);
  tables.set3(Buffer::mass, row, 4, i.x > 0 ? Vec3{1 / i.x, 1 / i.y, 1 / i.z} : Vec3{});
  tables.set(Buffer::motion, row, 3, 1 / m.mass);
  tables.set(Buffer::mass, row, 7, middle_axis(i));
}

int middle_axis(Vec3 i) {
  const double low = std::min({i.x, i.y, i.z}), high = std::max({i.x, i.y, i.z});
  const double values[3] = {i.x, i.y, i.z};
  int smallest = 0, largest = 2;
  for (int k = 2; k >= 0; k--)
    if (values[k] == low) smallest = k;
  for (int k = 0; k < 3; k++)
    if (values[k] == high && k != smallest) largest = k;
  return 3 - smallest - largest;
}

void WorldState::make_room(std::uint32_t more_bodies, std::uint32_t more_joints, std::uint32_t more_shapes) {
  body_ids.make_room(more_bodies);
  pcphys::make_room(bodies, more_bodies);
  tables.reserve(Table::body, std::uint32_t(bodies.size()) + more_bodies);
  joint_ids.make_room(more_joints);
  pcphys::make_room(joints, more_joints);
  tables.reserve(Table::joint, std::uint32_t(joints.size()) + more_joints);
  pcphys::make_room(shapes, more_shapes);
  free_shapes.reserve(shapes.capacity());
  tables.reserve(Table::shape, std::uint32_t(shapes.size()) + more_shapes + 1);
}

void WorldState::shrink() {
  settle_contacts();
  drops.shrink();
  // the next ones take these places, in the same order
  while (!shapes.empty() && !shapes.back().alive) shapes.pop_back();
  std::erase_if(free_shapes, [&](std::uint32_t shape) { return shape >= shapes.size(); });
  std::ranges::make_heap(free_shapes, std::greater<>());
  tables.resize(Table::shape, std::uint32_t(shapes.size()) + 1);
  structure_version++;
  tables.shrink();
  for (IdPool* ids : {&body_ids, &joint_ids, &force_ids}) ids->shrink();
  for (BodyRecord& body : bodies)
    for (auto* list : {&body.shapes, &body.forces, &body.joints}) list->shrink_to_fit();
  const auto shrink_all = [](auto&... columns) { (columns.shrink_to_fit(), ...); };
  shrink_all(bodies, joints, shapes, free_shapes, forces, contacts.keys, contacts.ends, contacts.features);
}

void WorldState::freeze(std::uint32_t row) {
  BodyRecord& body = bodies[row];
  if (body.frozen) return;
  frozen[body.index] = {tables.get(Buffer::mass, row, 3), tables.get3(Buffer::mass, row, 0)};
  body.frozen = true;
  for (const Buffer buffer : {Buffer::motion, Buffer::velocity_parts, Buffer::mass, Buffer::inertia, Buffer::delta})
    for (std::uint32_t i = 0; i < reals_of(buffer); i++) tables.set(buffer, row, i, 0);
  tables.set(Buffer::motion, row, 7, frozen_phase);
  if (asleep(row)) {  // what stands does not sleep
    tables.set(Buffer::rest, row, rest_asleep, 0);
    sleepers--;
    rest_version++;
  }
  structure_version++;
}

void WorldState::thaw(std::uint32_t row) {
  BodyRecord& body = bodies[row];
  if (!body.frozen) return;
  const MassProperties mass = frozen.extract(body.index).mapped();
  body.frozen = false;
  const bool dynamic = body.kind == BodyKind::dynamic;
  if (dynamic)
    set_mass(row, mass);
  else
    tables.set3(Buffer::mass, row, 4, {1, 1, 1});
  tables.set(Buffer::motion, row, 7, dynamic ? -1 : 0);
  structure_version++;
}

void WorldState::follow_mark(std::uint32_t row) {
  const double phase = tables.get(Buffer::motion, row, 7);
  if (phase == frozen_phase) return freeze(row);
  thaw(row);
  tables.set(Buffer::motion, row, 7, phase);
}

void WorldState::drop_force(std::uint32_t force) {
  if (forces[force].callback) callbacks--;
  forces[force] = {};
  force_ids.release(force);
}

void WorldState::sum_forces(std::uint32_t row) {
  Vec3 force, torque;
  for (std::uint32_t f : bodies[row].forces) {
    if (forces[f].callback) continue;
    force = force + forces[f].wrench.force;
    torque = torque + forces[f].wrench.torque;
  }
  give_forces(row, force, torque);
}

void WorldState::give_forces(std::uint32_t row, Vec3 force, Vec3 torque) {
  tables.set3(gathered ? gathered->force : Buffer::force, row, 0, force);
  tables.set3(gathered ? gathered->torque : Buffer::force, row, gathered ? 0 : 4, rotates(row) ? torque : Vec3{});
}

void WorldState::change_forces(std::uint32_t row) {
  const Vec3 force = given_force(row), torque = given_torque(row);
  sum_forces(row);
  kick(row, tables.get(Buffer::motion, row, 3) * (given_force(row) - force), given_torque(row) - torque);
}

void WorldState::kick(std::uint32_t row, Vec3 acceleration, Vec3 torque) {
  if (bodies[row].kind != BodyKind::dynamic || tables.get(Buffer::motion, row, 7) < 0 || last_substep == 0) return;
  const auto shift_by = [&](Vec3 change, double drag) {
    return change == Vec3{} ? change : half_kick(drag, last_substep) * change;
  };
  const Vec3 linear = shift_by(acceleration, tables.get(Buffer::force, row, 3));
  const Vec3 angular = shift_by(torque, tables.get(Buffer::force, row, 7));
  // more than the numbers hold: then the velocities start anew from what is read
  if (!(length(linear) <= constants::largest_state && length(angular) <= constants::largest_momentum))
    return bring_in_phase(row);
  const auto shift = [&](std::uint32_t offset, Vec3 by) {
    if (by == Vec3{}) return;
    tables.set3(Buffer::motion, row, offset, tables.get3(Buffer::motion, row, offset) + by);
    tables.set3(Buffer::velocity_parts, row, offset, tables.get3(Buffer::velocity_parts, row, offset) - by);
  };
  shift(0, linear);
  shift(4, angular);
}

}  // namespace pcphys
