#include "step/unrest.h"

#include <algorithm>
#include <cstring>

namespace pcphys {
namespace {

/// Whether a row's value is another than before; zero has no sign, as in the hash.
bool changed(const WorldState& s, const OwnArgument& a, const AlignedBytes& before, std::uint32_t row) {
  const std::size_t real = s.tables.real_bytes(), at = row * s.tables.row_bytes(a.buffer),
                    size = number_bytes(a.type, real);
  const std::byte *now = s.tables.bytes(a.buffer).data() + at, *then = before.data() + at;
  const std::uint32_t count = components(a.type);
  if (std::memcmp(now, then, count * size) == 0) return false;
  for (std::uint32_t c = 0; c < count; c++)
    if (read_number(now + c * size, a.type, real) != read_number(then + c * size, a.type, real)) return true;
  return false;
}

/// What it makes follows from bodies or joints alone.
bool total_of_bodies(const OwnKernel& k) {
  return k.form == OwnKernel::Form::reduction && (k.table == Table::body || k.table == Table::joint);
}
bool made_anew(OwnKernels::Ordered kernels, Buffer buffer) {
  return std::ranges::any_of(kernels, [&](const auto& k) {
    return std::ranges::any_of(k->arguments, [&](const OwnArgument& a) { return a.buffer == buffer && a.anew(); });
  });
}
bool some_awake(const WorldState& s) {
  if (s.stirred > 0) return true;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    if (s.goes(row)) return true;
  return false;
}

}  // namespace

bool Unrest::wakes_all(const WorldState& s, OwnKernels::Ordered kernels) {
  if (s.sleepers == 0) return false;
  return of_parameters(kernels) || (together(kernels) && some_awake(s));
}

bool Unrest::of_parameters(OwnKernels::Ordered kernels) {
  return std::ranges::any_of(
      kernels, [](const auto& k) { return !k->parameters_before.empty() && k->parameters_before != k->parameters; });
}

void Unrest::find(const WorldState& s, OwnKernels::Ordered kernels, const Runner& runner) {
  rows_.clear();
  if (of_parameters(kernels)) return rows_.assign(s.bodies.size(), true);
  find_behind(kernels);
  for (const auto& k : kernels)
    for (const OwnArgument& a : k->arguments) {
      if (!a.of_property() || !a.writes() || std::ranges::find(behind_, a.buffer) == behind_.end() ||
          !runner.before(a.buffer))
        continue;
      const bool of_row = a.table == Table::body || a.table == Table::joint;
      if (of_row ? !made_anew(kernels, a.buffer) : s.tables.rows(a.table) == 2 && !total_of_bodies(*k))
        mark(s, a, runner);
    }
}

bool Unrest::together(OwnKernels::Ordered kernels) {
  find_behind(kernels);
  return std::ranges::any_of(
      kernels, [&](const auto& k) { return k->form == OwnKernel::Form::pair && k->table == Table::body && moves(*k); });
}

/// Bodies, or what others move them by.
bool Unrest::moves(const OwnKernel& k) const {
  return !k.of_library() && std::ranges::any_of(k.arguments, [&](const OwnArgument& a) {
    return a.of_property() && a.writes() &&
           (!is_own(a.buffer) || std::ranges::find(behind_, a.buffer) != behind_.end());
  });
}

/// What kernels that move bodies name, and whatever that is made of.
void Unrest::find_behind(OwnKernels::Ordered kernels) {
  behind_.clear();
  for (std::size_t known = behind_.size() + 1; known != behind_.size();) {
    known = behind_.size();
    for (const auto& k : kernels) {
      if (!moves(*k)) continue;
      for (const OwnArgument& a : k->arguments)
        if (a.of_property() && is_own(a.buffer) && std::ranges::find(behind_, a.buffer) == behind_.end())
          behind_.push_back(a.buffer);
    }
  }
}

void Unrest::mark(const WorldState& s, const OwnArgument& a, const Runner& runner) {
  const AlignedBytes& before = *runner.before(a.buffer);
  const auto put = [&](std::uint32_t body) {
    if (rows_.empty()) rows_.assign(s.bodies.size(), false);
    rows_[body] = true;
  };
  for (std::uint32_t row = 1; row < s.tables.rows(a.table); row++) {
    if (!changed(s, a, before, row)) continue;
    if (a.table == Table::body) {
      put(row);
    } else if (a.table == Table::joint) {
      put(s.body_ids.row(s.joints[row].body_a));
      put(s.body_ids.row(s.joints[row].body_b));
    } else {
      return rows_.assign(s.bodies.size(), true);
    }
  }
}

void Unrest::stir_sleepers(WorldState& s) const {
  for (std::uint32_t row = 1; row < rows_.size() && s.sleepers > 0; row++)
    if (rows_[row] && s.asleep(row)) s.stir(row);
}

}  // namespace pcphys
