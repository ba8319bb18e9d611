// Where bodies are and how they move, as a host reads and writes it.
#include <cmath>

#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

Result<Pose> World::pose(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().pose(state().body_ids.row(body.index));
} catch (...) {
  return caught();
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
  return caught();
}

Result<Vec3> World::velocity(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().velocity(state().body_ids.row(body.index));
} catch (...) {
  return caught();
}

Status World::set_velocity(BodyId body, Vec3 velocity) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = check_finite(velocity, "velocity of a body"); !ok) return ok;
  const std::uint32_t row = state().body_ids.row(body.index);
  const BodyKind kind = state().bodies[row].kind;
  if (Status ok = check_moves(kind, velocity, "velocity"); !ok || kind == BodyKind::fixed) return ok;
  state().change(row);
  state().bring_in_phase(row);
  state().tables.set3(Buffer::motion, row, 0, velocity);
  return {};
} catch (...) {
  return caught();
}

Result<Vec3> World::angular_velocity(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().angular_velocity(state().body_ids.row(body.index));
} catch (...) {
  return caught();
}

Status World::set_angular_velocity(BodyId body, Vec3 w) try {
  if (Status ok = changeable(body); !ok) return ok;
  if (Status ok = check_finite(w, "angular velocity of a body"); !ok) return ok;
  const std::uint32_t row = state().body_ids.row(body.index);
  const BodyKind kind = state().bodies[row].kind;
  if (Status ok = check_moves(kind, w, "angular velocity"); !ok || kind == BodyKind::fixed) return ok;
  if (!state().rotates(row) && w != Vec3{}) return no_rotation();
  if (Status ok = check_spin(mass_properties(body)->moments, w); !ok) return ok;
  state().change(row);
  state().bring_in_phase(row);
  state().set_angular_velocity(row, w);
  return {};
} catch (...) {
  return caught();
}

Result<Vec3> World::angular_momentum(BodyId body) const try {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state().body_ids.row(body.index);
  return state().bodies[row].kind == BodyKind::dynamic ? state().momentum_of_rotation(row) : Vec3{};
} catch (...) {
  return caught();
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
  return caught();
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
  return caught();
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
  return caught();
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
  return caught();
}

}  // namespace pcphys
