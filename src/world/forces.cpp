// Forces of a world.
#include <algorithm>
#include <utility>
#include <vector>

#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

namespace {
ForceId new_force(WorldState& s, ForceRecord record) {
  const std::uint32_t row = s.body_ids.row(record.body);
  s.force_ids.make_room(1);
  make_room(s.forces);
  make_room(s.bodies[row].forces);
  const std::uint32_t index = s.force_ids.allocate(0);
  if (index == s.forces.size()) s.forces.emplace_back();
  s.change(row);
  if (record.callback) s.callbacks++;
  if (record.callback) s.bring_in_phase(row);  // what it will answer is not known yet
  s.forces[index] = std::move(record);
  std::vector<std::uint32_t>& own = s.bodies[row].forces;
  own.insert(std::ranges::lower_bound(own, index), index);
  s.change_forces(row);
  return s.force_ids.id<ForceId>(index);
}
}  // namespace

Result<ForceId> World::add_force(BodyId body, const Wrench& wrench) try {
  if (Status ok = changeable(body); !ok) return ok.error();
  if (Status ok = check_finite(wrench.force, "force on a body"); !ok) return ok.error();
  if (Status ok = check_finite(wrench.torque, "torque on a body"); !ok) return ok.error();
  return new_force(state(), {body.index, wrench, {}});
} catch (...) {
  return caught();
}

Result<ForceId> World::add_force(BodyId body, ForceCallback callback) try {
  if (Status ok = changeable(body); !ok) return ok.error();
  if (!callback) return Error{ErrorCode::bad_argument, "The force callback is empty; pass a function."};
  return new_force(state(), {body.index, {}, std::move(callback)});
} catch (...) {
  return caught();
}

Status World::remove(ForceId force) try {
  if (Status ok = changeable(); !ok) return ok;
  WorldState& s = state();
  if (!s.force_ids.valid(force)) return stale("force");
  const std::uint32_t row = s.body_ids.row(s.forces[force.index].body);
  s.change(row);
  std::erase(s.bodies[row].forces, force.index);
  s.drop_force(force.index);
  s.change_forces(row);
  return {};
} catch (...) {
  return caught();
}

}  // namespace pcphys
