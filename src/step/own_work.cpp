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
// where some make forces once a step and others in each sub-step: what those have made, for these to begin with
PCPHYS_KERNEL(pc_hold_forces,
              (PC_IN(Vec3) force, PC_IN(Vec3) torque, PC_OUT(Vec3) pc_held_force, PC_OUT(Vec3) pc_held_torque), {
                pc_held_force = force;
                pc_held_torque = torque;
              })
PCPHYS_KERNEL(pc_take_forces,
              (PC_IN(Vec3) pc_held_force, PC_IN(Vec3) pc_held_torque, PC_OUT(Vec3) force, PC_OUT(Vec3) torque), {
                force = pc_held_force;
                torque = pc_held_torque;
              })

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
  s.gathered = {force, add_column(s, "pc_given_torque", "N m"), false};
  sum_all(s);
}

/// As long as the world's forces are gathered.
void add_held(WorldState& s) {
  if (s.gathered->holds) return;
  s.gathered->holds = true;
  add_column(s, "pc_held_force", "N");
  add_column(s, "pc_held_torque", "N m");
}

/// All columns of the library's own are of forces.
void stop_gathering(WorldState& s) {
  for (OwnProperty& p : s.own.list)
    if (p.used && p.name.starts_with(own_prefix)) {
      s.tables.remove(p.buffer);
      p.used = false;
    }
  s.removals++;
  s.gathered.reset();
  sum_all(s);
}

/// Kernels that went with a stepper's list of them, or with the stepper: what they held up falls, and nobody gathers
/// forces for them.
void forget_gone(WorldState& s) {
  if (std::erase_if(s.kernel_holds, [](const auto& hold) { return hold.expired(); }) == 0) return;
  if (s.kernel_holds.empty() && s.gathered) stop_gathering(s);
  s.stir_all();
}

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
  return "row " + std::to_string(row) + " of \"" + std::string(s.own.table_name(a.table)) + "\"";
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
  return std::ranges::none_of(
      k.arguments, [&](const OwnArgument& a) { return a.of_property() && !a.writes() && bad_row(s, a) != 0; });
}

Status OwnWork::check_written(const WorldState& s) const {
  for (const auto& k : ordered())
    for (const OwnArgument& a : k->arguments)
      if (a.writes() && is_own(a.buffer) && !k->of_library() && bad_row(s, a) != 0) return pcphys::check_written(s, *k);
  return {};
}

bool OwnWork::hosts() const {
  return std::ranges::any_of(ordered(), [](const auto& k) { return !k->of_library(); });
}
OwnWork::Makers OwnWork::makers() const {
  Makers found;
  for (const auto& k : ordered())
    if (!k->of_library() && k->writes(Buffer::force)) (k->once_a_step ? found.once : found.each) = true;
  return found;
}

Status OwnWork::check(const WorldState& s) const {
  if (of_another(s))
    return Error{
        ErrorCode::bad_argument,
        "This stepper has kernels of another world (Stepper::add_kernel); step that one, use another stepper, or "
        "take them away (Stepper::remove_kernels)."};
  if (removals_ == s.removals) return {};
  for (const auto& k : ordered())
    if (!k->of_library())
      if (Status ok = check_properties(s, *k); !ok) return ok;
  return {};
}

Status OwnWork::follow(WorldState& s) {
  forget_gone(s);
  if (kernels_.empty() && !s.gathered) return {};
  if (Status ok = check(s); !ok) return ok;
  if (serial_ != s.serial || removals_ != s.removals) forget_beginning();
  serial_ = s.serial;
  const Status ok = begin_forces(s);
  removals_ = s.removals;
  return ok;
}

void OwnWork::take_hold(WorldState& s) {
  if (hold_) return;
  hold_ = std::make_shared<const char>();
  s.kernel_holds.push_back(hold_);
}

void OwnWork::let_go(WorldState& s) {
  std::erase_if(s.kernel_holds, [&](const auto& hold) { return hold.lock() == hold_; });
  hold_.reset();
}

void OwnWork::clear() {
  kernels_.clear();
  hold_.reset();
}

void OwnWork::forget_beginning() {
  for (const KernelText& text : {pc_gather_forces::text(), pc_hold_forces::text(), pc_take_forces::text()})
    (void)kernels_.remove(text.name);
}

Status OwnWork::begin_forces(WorldState& s) {
  const Makers make = makers();
  if (make.any() && !s.gathered) gather_forces(s);
  const bool gather_once = make.once || !make.each;
  const OwnKernel* gathers = kernels_.find(pc_gather_forces::text().name);
  const bool holds = kernels_.find(pc_hold_forces::text().name);
  if (gathers && s.gathered && gathers->once_a_step == gather_once && holds == make.both()) return {};
  forget_beginning();
  if (!s.gathered) return {};
  if (make.both()) add_held(s);
  Status ok = add_beginning(s, pc_gather_forces::text(), gather_once);
  if (ok && make.both()) ok = add_beginning(s, pc_hold_forces::text(), true);
  if (ok && make.both()) ok = add_beginning(s, pc_take_forces::text(), false);
  return ok;
}

Status OwnWork::add_beginning(const WorldState& s, const KernelText& text, bool once_a_step) {
  KernelDef def;
  def.text = text;
  def.once_a_step = once_a_step;
  auto kernel = resolve(s, def);
  return kernel ? kernels_.add(std::move(*kernel)) : Status(kernel.error());
}

Result<const OwnKernel*> OwnWork::add(WorldState& s, const KernelDef& def) {
  auto kernel = resolve(s, def);
  if (!kernel) return kernel.error();
  const OwnKernel* added = kernel->get();
  if (added->writes(Buffer::force)) forget_beginning();  // follows anew
  if (Status ok = kernels_.add(std::move(*kernel)); !ok) return ok.error();
  serial_ = s.serial;
  removals_ = s.removals;
  take_hold(s);
  return added;
}

void OwnWork::put_back(const OwnWork& before) {
  kernels_.put_back(before.kernels_);
  serial_ = before.serial_;
  removals_ = before.removals_;
  hold_ = before.hold_;
}

Status OwnWork::remove(WorldState& s, std::string_view name) {
  if (serial_ != s.serial)
    return Error{ErrorCode::bad_argument,
                 "This stepper has no kernels of this world; remove_kernel takes the world that they were added for."};
  const bool made = makers().any();
  if (Status ok = kernels_.remove(name); !ok) return ok;
  if (hold_ && !hosts()) let_go(s);
  if (made && !makers().any()) {
    forget_beginning();
    stop_gathering(s);
  }
  return {};
}

}  // namespace pcphys
