#include "step/force_jumps.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace pcphys {
namespace {

bool of_moment(const OwnKernel& k) {
  return k.stage == Stage::integrate && !k.after && k.form == OwnKernel::Form::element && k.loop;
}
bool changed(const OwnKernel& k) { return !k.parameters_before.empty() && k.parameters_before != k.parameters; }

/// What the library gives to kernels, in this order: gravity, then h of those of each sub-step
/// and of those of each step.
template <class Scalar> void fill(std::byte* given, Vec3 gravity, double h, double step) {
  const Scalar values[5] = {Scalar(gravity.x), Scalar(gravity.y), Scalar(gravity.z), Scalar(h), Scalar(step)};
  std::memcpy(given, values, sizeof values);
}
std::size_t place_in_given(const OwnKernel& k, const OwnArgument& a) {
  return a.name != "h" ? 0 : k.once_a_step ? 4 : 3;
}
template <class Scalar>
Vec3 difference(std::span<const std::byte> now, std::span<const std::byte> before, std::size_t place) {
  Scalar a[3], b[3];
  std::memcpy(a, now.data() + place, sizeof a);
  std::memcpy(b, before.data() + place, sizeof b);
  return Vec3{a[0], a[1], a[2]} - Vec3{b[0], b[1], b[2]};
}

void copy(const AlignedBytes& from, std::vector<std::byte>& to) { to.assign(from.data(), from.data() + from.size()); }

}  // namespace

void ForceJumps::forget(OwnKernels::Ordered kernels) {
  for (const auto& k : kernels) k->parameters_before.clear();
}

void ForceJumps::act(WorldState& s, OwnKernels::Ordered kernels, std::span<const std::uint32_t> bodies, double h,
                     double step, Runner& runner) {
  const bool jump = std::ranges::any_of(kernels, [](const auto& k) { return of_moment(*k) && changed(*k); });
  const bool forces = std::ranges::any_of(kernels, [](const auto& k) { return k->writes(Buffer::force); });
  if (!jump || !forces || s.last_substep == 0) return;
  const bool single = s.tables.precision() == Precision::f32;
  single ? fill<float>(given_, s.gravity, h, step) : fill<double>(given_, s.gravity, h, step);
  keep(s, kernels);
  evaluate(s, kernels, bodies, true, old_);
  evaluate(s, kernels, bodies, false, new_);
  runner.keep(s, Buffer::motion);
  runner.keep(s, Buffer::velocity_parts);
  const auto by = single ? difference<float> : difference<double>;
  for (const std::uint32_t row : bodies) {
    const std::size_t place = row * s.tables.row_bytes(Buffer::force);
    if (row == 0) continue;  // pads
    s.kick(row, s.tables.get(Buffer::motion, row, 3) * by(new_, old_, place),
           by(new_, old_, place + 4 * s.tables.real_bytes()));
  }
}

void ForceJumps::keep(const WorldState& s, OwnKernels::Ordered kernels) {
  std::size_t n = 0;
  for (const auto& k : kernels)
    for (const Access& a : k->accesses) {
      const auto end = kept_.begin() + std::ptrdiff_t(n);
      if (!of_moment(*k) || !a.write ||
          std::find_if(kept_.begin(), end, [&](const Kept& x) { return x.buffer == a.buffer; }) != end)
        continue;
      if (kept_.size() == n) kept_.emplace_back();
      kept_[n].buffer = a.buffer;
      copy(s.tables.bytes(a.buffer), kept_[n++].bytes);
    }
  kept_.resize(n);
}

void ForceJumps::put_back(WorldState& s) const {
  for (const Kept& kept : kept_) std::ranges::copy(kept.bytes, s.tables.bytes(kept.buffer).data());
}

void ForceJumps::evaluate(WorldState& s, OwnKernels::Ordered kernels, std::span<const std::uint32_t> bodies,
                          bool before, std::vector<std::byte>& forces) {
  for (const bool once_a_step : {true, false})  // in the order of plans
    for (const auto& k : kernels)
      if (of_moment(*k) && k->once_a_step == once_a_step) run(s, *k, bodies, before);
  copy(s.tables.bytes(Buffer::force), forces);
  put_back(s);
}

void ForceJumps::run(WorldState& s, const OwnKernel& k, std::span<const std::uint32_t> bodies, bool before) const {
  std::array<std::byte*, OwnKernel::most_arguments> columns{};
  std::array<std::size_t, OwnKernel::most_arguments> strides{};
  const std::byte* const parameters = (before && changed(k) ? k.parameters_before : k.parameters).data();
  for (std::size_t i = 0; i < k.arguments.size(); i++) {
    const OwnArgument& a = k.arguments[i];
    if (a.of_property()) {
      columns[i] = s.tables.bytes(a.buffer).data() + a.offset + (a.single ? a.row_bytes : 0);
      strides[i] = a.single ? 0 : a.row_bytes;
    } else {  // loops read it alone
      columns[i] =
          const_cast<std::byte*>(a.given ? given_ + place_in_given(k, a) * k.real_bytes : parameters + a.place);
    }
  }
  const bool of_bodies = k.table == Table::body;
  const std::uint32_t end = of_bodies ? std::uint32_t(bodies.size()) : s.tables.rows(k.table);
  k.loop({columns.data(), strides.data(), of_bodies ? bodies.data() : nullptr, of_bodies ? 0u : 1u, end});
}

}  // namespace pcphys
