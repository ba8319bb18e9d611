#include "world/range.h"

#include <algorithm>
#include <cmath>

#include "pcphys/constants.h"

namespace pcphys {
namespace {

/// Sum of sizes: no smaller than the length, and not finite where a component is not.
template <class Scalar> Scalar size(const Scalar* v) { return std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]); }

template <class Scalar> struct Body {
  const Scalar *motion, *pose, *inverse, *force;

  Body(const Tables& t, std::uint32_t row)
      : motion(t.data<Scalar>(Buffer::motion) + row * reals_of(Buffer::motion)),
        pose(t.data<Scalar>(Buffer::pose) + row * reals_of(Buffer::pose)),
        inverse(t.data<Scalar>(Buffer::mass) + row * reals_of(Buffer::mass) + 4),
        force(t.data<Scalar>(Buffer::force) + row * reals_of(Buffer::force)) {}
  Scalar light() const { return std::max(inverse[0], std::max(inverse[1], inverse[2])); }

  // what is not a number is not below anything
  bool outside() const {
    const Scalar limit = Scalar(constants::largest_state);
    const bool place = size(pose) < limit, turned = size(pose + 4) + std::fabs(pose[7]) < Scalar(4);
    const bool speed = size(motion) < limit, spin = size(motion + 4) * light() < limit;
    return !(place & turned & speed & spin);
  }
  bool leaving(double dt, double fall) const {
    const double speed = double(size(motion)) + dt * (fall + double(size(force)) * double(motion[3]));
    const double spin = (double(size(motion + 4)) + dt * double(size(force + 4))) * double(light());
    const double limit = constants::largest_state;
    return !(speed < limit && spin < limit && double(size(pose)) + dt * speed < limit);
  }
};

template <class Out>
void collect(std::span<const std::uint32_t> bodies, std::vector<std::uint32_t>& rows, const Out& out) {
  rows.clear();
  for (const std::uint32_t row : bodies)
    if (out(row)) rows.push_back(row);
}

/// Without a branch for each number: hardly ever is one found.
template <class Scalar> bool finite(const std::byte* p, std::uint32_t count) {
  Scalar none = 0;
  for (std::uint32_t c = 0; c < count; c++) none += Scalar(0) * reinterpret_cast<const Scalar*>(p)[c];
  return none == 0;
}

}  // namespace

std::uint32_t find_not_finite(const Tables& tables, Buffer buffer, std::uint32_t offset, PropertyType type,
                              std::uint32_t begin, std::uint32_t end) {
  if (type == PropertyType::int32 || type == PropertyType::uint32) return end;
  const std::byte* const rows = tables.bytes(buffer).data() + offset;
  const std::size_t stride = tables.row_bytes(buffer);
  const bool wide = number_bytes(type, tables.real_bytes()) == 8;
  const std::uint32_t count = components(type);
  std::uint32_t row = begin;
  while (row < end && (wide ? finite<double>(rows + row * stride, count) : finite<float>(rows + row * stride, count)))
    row++;
  return row;
}

void find_outside(const WorldState& state, std::span<const std::uint32_t> bodies, std::vector<std::uint32_t>& outside) {
  const Tables& t = state.tables;
  if (t.precision() == Precision::f32)
    collect(bodies, outside, [&t](std::uint32_t row) { return Body<float>(t, row).outside(); });
  else
    collect(bodies, outside, [&t](std::uint32_t row) { return Body<double>(t, row).outside(); });
}

void find_leaving(const WorldState& state, std::span<const std::uint32_t> bodies, double dt,
                  std::vector<std::uint32_t>& leaving) {
  const Tables& t = state.tables;
  const double fall = length(state.gravity);
  if (t.precision() == Precision::f32)
    collect(bodies, leaving, [&](std::uint32_t row) { return Body<float>(t, row).leaving(dt, fall); });
  else
    collect(bodies, leaving, [&](std::uint32_t row) { return Body<double>(t, row).leaving(dt, fall); });
}

}  // namespace pcphys
