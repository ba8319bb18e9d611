#include "step/own_work.h"

#include <algorithm>
#include <array>
#include <string>

#include "pcphys/write_kernel.h"
#include "world/range.h"

namespace pcphys {
namespace {

PCPHYS_KERNEL(pc_gather_forces,
              (PC_IN(Vec3) pc_given_force, PC_IN(Vec3) pc_given_torque, PC_OUT(Vec3) force, PC_OUT(Vec3) torque), {
                force = pc_given_force;
                torque = pc_given_torque;
              })

bool of_library(const OwnKernel& k) { return k.name.starts_with(own_prefix); }

Buffer add_column(WorldState& s, const char* name, const char* unit) {
  const std::array<std::byte, 4 * 8> zero{};
  const Buffer buffer =
      s.tables.add(Table::body, std::span(zero).first(own_row_bytes(PropertyType::vec3, s.tables.real_bytes())));
  s.own.add({name, unit, PropertyType::vec3, Role::input, Table::body, buffer});
  return buffer;
}

void sum_all(WorldState& s) {
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) s.sum_forces(row);
}

void gather_forces(WorldState& s) {
  const Buffer force = add_column(s, "pc_given_force", "N");
  s.gathered = {force, add_column(s, "pc_given_torque", "N m")};
  sum_all(s);
}

void stop_gathering(WorldState& s) {
  for (OwnProperty& p : s.own.list)
    if (p.used && (p.buffer == s.gathered->force || p.buffer == s.gathered->torque)) {
      s.tables.remove(p.buffer);
      p.used = false;
    }
  s.removals++;
  s.gathered.reset();
  sum_all(s);
}

}  // namespace

namespace {

/// Of an argument the first row that is not finite; 0: none.
std::uint32_t bad_row(const WorldState& s, const OwnArgument& a) {
  const std::uint32_t rows = a.single ? 2 : s.tables.rows(a.table);
  const std::uint32_t row = find_not_finite(s.tables, a.buffer, a.offset, a.type, 1, rows);
  return row < rows ? row : 0;
}
std::string object(const WorldState& s, const OwnArgument& a, std::uint32_t row) {
  if (a.single) return "the total of all rows";
  if (a.table == Table::body) return "body " + std::to_string(s.bodies[row].index);
  if (a.table == Table::joint) return "joint " + std::to_string(s.joints[row].index);
  for (const OwnTable& t : s.own.tables)
    if (t.used && t.table == a.table) return "row " + std::to_string(row) + " of \"" + t.name + "\"";
  return "row " + std::to_string(row);
}

}  // namespace

Status check_written(const WorldState& s, const OwnKernel& k) {
  for (const OwnArgument& a : k.arguments)
    if (const std::uint32_t row = a.writes() ? bad_row(s, a) : 0)
      return Error{ErrorCode::not_finite,
                   "The kernel \"" + k.name + "\" gave " + object(s, a, row) + " a \"" + a.property +
                       "\" that is no finite number; look for a division by zero or a root of what is below "
                       "it. The world is as before the step."};
  return {};
}

bool reads_finite(const WorldState& s, const OwnKernel& k) {
  return std::ranges::none_of(k.arguments,
                              [&](const OwnArgument& a) { return a.of_property() && !a.writes() && bad_row(s, a) != 0; });
}

Status OwnWork::check_written(const WorldState& s) const {
  for (const auto& k : ordered())
    for (const OwnArgument& a : k->arguments)
      if (a.writes() && is_own(a.buffer) && !of_library(*k) && bad_row(s, a) != 0) return pcphys::check_written(s, *k);
  return {};
}

bool OwnWork::hosts() const {
  return std::ranges::any_of(ordered(), [](const auto& k) { return !of_library(*k); });
}
bool OwnWork::makes_forces() const {
  return std::ranges::any_of(ordered(), [](const auto& k) { return !of_library(*k) && k->writes(Buffer::force); });
}

Status OwnWork::check(const WorldState& s) const {
  if (of_another(s))
    return Error{ErrorCode::bad_argument,
                 "This stepper has kernels of another world (Stepper::add_kernel); step that one, or use another stepper."};
  if (removals_ == s.removals) return {};
  for (const auto& k : ordered())
    if (!of_library(*k))
      if (Status ok = check_properties(s, *k); !ok) return ok;
  return {};
}

Status OwnWork::follow(WorldState& s) {
  if (kernels_.empty() && !s.gathered) return {};
  if (Status ok = check(s); !ok) return ok;
  if (serial_ != s.serial || removals_ != s.removals) (void)kernels_.remove(pc_gather_forces::text().name);
  serial_ = s.serial;
  const Status ok = begin_forces(s);
  removals_ = s.removals;
  return ok;
}

Status OwnWork::begin_forces(WorldState& s) {
  const std::string_view name = pc_gather_forces::text().name;
  if (makes_forces() && !s.gathered) gather_forces(s);
  const OwnKernel* there = kernels_.find(name);
  const bool each = std::ranges::any_of(
      ordered(), [](const auto& k) { return !of_library(*k) && k->writes(Buffer::force) && !k->once_a_step; });
  if (there && s.gathered && there->once_a_step == !each) return {};
  if (there) (void)kernels_.remove(name);
  if (!s.gathered) return {};
  KernelDef def;
  def.text = pc_gather_forces::text();
  def.once_a_step = !each;
  auto kernel = resolve(s, def);
  return kernel ? kernels_.add(std::move(*kernel)) : Status(kernel.error());
}

Result<const OwnKernel*> OwnWork::add(WorldState& s, const KernelDef& def) {
  auto kernel = resolve(s, def);
  if (!kernel) return kernel.error();
  const OwnKernel* added = kernel->get();
  if (added->writes(Buffer::force)) (void)kernels_.remove(pc_gather_forces::text().name);  // follows anew
  if (Status ok = kernels_.add(std::move(*kernel)); !ok) return ok.error();
  serial_ = s.serial;
  removals_ = s.removals;
  return added;
}

Status OwnWork::remove(WorldState& s, std::string_view name) {
  if (serial_ != s.serial)
    return Error{ErrorCode::bad_argument,
                 "This stepper has no kernels of this world; remove_kernel takes the world that they were added for."};
  const bool made = makes_forces();
  if (Status ok = kernels_.remove(name); !ok) return ok;
  if (made && !makes_forces()) {
    (void)kernels_.remove(pc_gather_forces::text().name);
    stop_gathering(s);
  }
  return {};
}

}  // namespace pcphys
