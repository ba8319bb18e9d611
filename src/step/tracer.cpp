#include "step/tracer.h"

#include "plan/island_class.h"

namespace pcphys {
namespace {

// Places in the rows of contacts: contact_rows.inl.
constexpr std::uint32_t row_approach = 36, impulse_friction = 4;

bool stores(Kernel kernel) { return kernel == Kernel::contact_store || kernel == Kernel::contact_store_frictionless; }

/// Field `field` of a slot, in arrays of structures of `width` arrays.
template <class Scalar>
double field_of(const void* rows, std::size_t reals, std::uint32_t width, std::uint32_t slot, std::uint32_t field) {
  const std::size_t block = slot / width, lane = slot % width;
  return double(static_cast<const Scalar*>(rows)[(block * reals + field) * width + lane]);
}

}  // namespace

bool ends_substep(const PlanEntry& before, const PlanEntry& next) {
  const auto is_kernel = [](const PlanEntry& e) { return e.kind == PlanEntry::Kind::kernel && !e.own; };
  if (!is_kernel(before) || !is_kernel(next)) return false;
  if (stores(before.kernel)) return false;
  return stores(next.kernel) || before.octave != next.octave || before.substep != next.substep;
}

template <class Scalar>
void Tracer::collect(const Schedule& schedule, unsigned octave, const Backend& backend, const TracedRows& rows) {
  const void* impulses = backend.scratch(Buffer::contact_impulses);
  const Buffer buffer = rows.friction ? Buffer::contact_rows : Buffer::frictionless_rows;
  const void* approaches = backend.scratch(buffer);
  if (!impulses || !approaches) return;
  const std::size_t impulse_reals = schema(Buffer::contact_impulses).reals, row_reals = schema(buffer).reals;
  const auto order = const_cast<Schedule&>(schedule).contacts.order();
  for (const Range& range : schedule.contacts.ranges(octave)) {
    for (std::uint32_t slot = range.begin * rows.width; slot < range.end * rows.width; slot++) {
      TracedContact c;
      c.contact = order[slot];
      if (c.contact == 0) continue;
      for (std::uint32_t i = 0; i < 4; i++) {
        c.impulse[i] = field_of<Scalar>(impulses, impulse_reals, rows.width, slot, i);
        c.struck[i] = field_of<Scalar>(approaches, row_reals, rows.width, slot, row_approach + i);
      }
      for (std::uint32_t i = 0; i < 2 && rows.friction; i++)
        c.friction[i] = field_of<Scalar>(impulses, impulse_reals, rows.width, slot, impulse_friction + i);
      contacts_.push_back(c);
    }
  }
}

void Tracer::substep(const WorldState& state, const Schedule& schedule, unsigned octave, const Backend& backend,
                     const TracedRows& rows, double h) {
  contacts_.clear();
  if (rows.f64)
    collect<double>(schedule, octave, backend, rows);
  else
    collect<float>(schedule, octave, backend, rows);
  told->substep(state, h, contacts_);
}

}  // namespace pcphys
