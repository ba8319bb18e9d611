// What a world tells of itself: energy and momentum.
#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

double World::kinetic_energy() const {
  const WorldState& s = state();
  double sum = 0;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) {
    if (s.bodies[row].kind != BodyKind::dynamic) continue;
    const Vec3 v = s.velocity(row);
    sum += 0.5 * s.tables.get(Buffer::mass, row, 3) * dot(v, v) +
           0.5 * dot(s.angular_velocity(row), s.momentum_of_rotation(row));
  }
  return sum;
}

double World::potential_energy() const {
  const WorldState& s = state();
  double sum = 0;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    sum -= s.tables.get(Buffer::mass, row, 3) * dot(s.gravity, s.pose(row).position);
  return sum;
}

Vec3 World::momentum() const {
  const WorldState& s = state();
  Vec3 sum;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    sum = sum + s.tables.get(Buffer::mass, row, 3) * s.tables.get3(Buffer::motion, row, 0);
  return sum;
}

Vec3 World::angular_momentum() const {
  const WorldState& s = state();
  Vec3 sum;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    if (s.bodies[row].kind == BodyKind::dynamic)
      sum = sum + s.tables.get3(Buffer::motion, row, 4) +
            s.tables.get(Buffer::mass, row, 3) * cross(s.pose(row).position, s.tables.get3(Buffer::motion, row, 0));
  return sum;
}

std::size_t World::contact_count() const { return settled().contact_rows() - 1; }

Status World::shrink() try {
  if (Status ok = changeable(); !ok) return ok;
  state().shrink();
  return {};
} catch (...) {
  return caught();
}

std::size_t World::memory_bytes() const { return state().memory_bytes(); }

}  // namespace pcphys
