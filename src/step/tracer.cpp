#include "step/tracer.h"

#include <algorithm>

namespace pcphys {
namespace {

// Places in the rows of contacts (contact_rows.inl); tests/contact_trace.cpp fails where they are others.
constexpr std::uint32_t row_approach = 36, impulse_friction = 4;

bool stores(Kernel kernel) { return kernel == Kernel::contact_store || kernel == Kernel::contact_store_frictionless; }

/// Rows of a buffer, in arrays of structures of `width` arrays.
template <class Scalar> class Rows {
 public:
  Rows(const Backend& backend, Buffer buffer, std::uint32_t width)
      : at_(static_cast<const Scalar*>(backend.scratch(buffer))), reals_(schema(buffer).reals), width_(width) {}
  double field(std::uint32_t slot, std::uint32_t field) const {
    const std::size_t block = slot / width_, lane = slot % width_;
    return double(at_[(block * reals_ + field) * width_ + lane]);
  }

 private:
  const Scalar* at_;
  std::size_t reals_;
  std::uint32_t width_;
};

}  // namespace

bool ends_substep(const PlanEntry& before, const PlanEntry& next) {
  const auto is_kernel = [](const PlanEntry& e) { return e.kind == PlanEntry::Kind::kernel && !e.own; };
  if (!is_kernel(before) || !is_kernel(next)) return false;
  // (the last one of an octave is followed by contact_store, and that by others of its substep)
  if (stores(next.kernel)) return true;
  return !stores(before.kernel) && before.octave == next.octave && before.substep < next.substep;
}

template <class Scalar> void Tracer::substep_of(const TracedRun& run, const void* infos, std::size_t block) {
  const ColouredSlots& slots = run.schedule.contacts;
  const auto frictionless = [](const PlanBinding& b) { return b.buffer == Buffer::frictionless_rows; };
  const bool friction = std::ranges::none_of(run.plan.bindings, frictionless);
  const Rows<Scalar> impulses(run.backend, Buffer::contact_impulses, slots.width());
  const Rows<Scalar> rows(run.backend, friction ? Buffer::contact_rows : Buffer::frictionless_rows, slots.width());
  contacts_.clear();
  for (const Range& range : slots.ranges(run.entry.octave))
    for (std::uint32_t slot = range.begin * slots.width(); slot < range.end * slots.width(); slot++) {
      TracedContact c;
      c.contact = slots.order()[slot];
      if (c.contact == 0) continue;  // padding
      for (std::uint32_t i = 0; i < 4; i++) {
        c.impulse[i] = impulses.field(slot, i);
        c.struck[i] = rows.field(slot, row_approach + i);
      }
      for (std::uint32_t i = 0; i < 2 && friction; i++) c.friction[i] = impulses.field(slot, impulse_friction + i);
      contacts_.push_back(c);
    }
  told->substep(run.state, double(static_cast<const InfoOf<Scalar>*>(infos)[block].h), contacts_);
}

void Tracer::substep(const TracedRun& run, const void* infos, std::size_t block) {
  if (run.state.tables.precision() == Precision::f64)
    substep_of<double>(run, infos, block);
  else
    substep_of<float>(run, infos, block);
}

}  // namespace pcphys
