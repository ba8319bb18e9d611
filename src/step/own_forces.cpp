#include "step/own_forces.h"

#include <array>

#include "pcphys/write_kernel.h"

namespace pcphys {
namespace {

PCPHYS_KERNEL(pc_gather_forces,
              (PC_IN(Vec3) pc_given_force, PC_IN(Vec3) pc_given_torque, PC_OUT(Vec3) force, PC_OUT(Vec3) torque), {
                force = pc_given_force;
                torque = pc_given_torque;
              })

Buffer add_column(WorldState& s, const char* name) {
  const std::array<std::byte, 4 * 8> zero{};
  const Buffer buffer =
      s.tables.add(Table::body, std::span(zero).first(own_row_bytes(PropertyType::vec3, s.tables.real_bytes())));
  OwnProperty p;
  p.name = name;
  p.unit = "N";
  p.type = PropertyType::vec3;
  p.role = Role::input;
  p.table = Table::body;
  p.buffer = buffer;
  p.used = true;
  s.own.add(std::move(p));
  return buffer;
}

void sum_all(WorldState& s) {
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) s.sum_forces(row);
}

}  // namespace

void gather_forces(WorldState& s) {
  if (s.gathered) return;
  const Buffer force = add_column(s, "pc_given_force");
  s.gathered = {force, add_column(s, "pc_given_torque")};
  sum_all(s);
}

void stop_gathering(WorldState& s) {
  if (!s.gathered) return;
  for (OwnProperty& p : s.own.list)
    if (p.used && (p.buffer == s.gathered->force || p.buffer == s.gathered->torque)) {
      s.tables.remove(p.buffer);
      p.used = false;
    }
  s.gathered.reset();
  sum_all(s);
}

KernelDef gathering(bool once_a_step) {
  KernelDef def;
  def.text = pc_gather_forces::text();
  def.once_a_step = once_a_step;
  return def;
}

}  // namespace pcphys
