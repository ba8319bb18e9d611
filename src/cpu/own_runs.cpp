#include "cpu/own_runs.h"

#include <algorithm>
#include <cstring>

namespace pcphys {
namespace {

constexpr std::uint32_t grain = 16;  // rows that are worth another thread

const std::uint32_t* list(std::span<void* const> buffers, Buffer buffer) {
  return static_cast<const std::uint32_t*>(buffers[std::size_t(buffer)]);
}

/// part(begin, end) over all of a range, on several threads where there are any.
template <class Part> void share(const Range& range, const Workers* workers, const Part& part) {
  if (!workers || workers->threads() == 1) return part(range.begin, range.end);
  workers->run(range.end - range.begin, grain,
               [&](std::uint32_t begin, std::uint32_t end) { part(range.begin + begin, range.begin + end); });
}

// ---- reductions ---------------------------------------------------------------------------------------
/// What cannot be ordered is added: a NaN stays one, to be told of.
template <class T> T combined(OwnArgument::Kind kind, T a, T b) {
  if (kind == OwnArgument::Kind::least && b < a) return b;
  if (kind == OwnArgument::Kind::most && a < b) return b;
  if (kind >= OwnArgument::Kind::least && (a <= b || b <= a)) return a;
  return a + b;
}
/// `count` values of `numbers` numbers each to one, in place of the first: two by two, then two by two of these.
template <class T> void combine(OwnArgument::Kind kind, std::byte* values, std::size_t count, std::uint32_t numbers) {
  T* const x = reinterpret_cast<T*>(values);
  for (std::size_t step = 1; step < count; step *= 2)
    for (std::size_t i = 0; i + step < count; i += 2 * step)
      for (std::uint32_t c = 0; c < numbers; c++)
        x[i * numbers + c] = combined(kind, x[i * numbers + c], x[(i + step) * numbers + c]);
}
void combine(const OwnArgument& a, std::size_t real_bytes, std::byte* values, std::size_t count) {
  const std::uint32_t numbers = components(a.type);
  if (a.type == PropertyType::int32) return combine<std::int32_t>(a.kind, values, count, numbers);
  if (a.type == PropertyType::uint32) return combine<std::uint32_t>(a.kind, values, count, numbers);
  if (number_bytes(a.type, real_bytes) == 4) return combine<float>(a.kind, values, count, numbers);
  combine<double>(a.kind, values, count, numbers);
}

std::size_t value_bytes(const OwnArgument& a, std::size_t real_bytes) {
  return components(a.type) * number_bytes(a.type, real_bytes);
}

// ---- what joints give to bodies -----------------------------------------------------------------------
/// What bodies take: their list, the ends of each (OwnLists::body_joints), and the terms of one argument, by joint row.
struct Ends {
  const std::uint32_t *bodies, *joints;
  const std::byte* terms;
  std::byte* column;
  std::size_t stride;
  std::uint32_t side;  // 0: of those of which the body is a; 1: of which it is b
};
template <class T, std::uint32_t numbers> void add_ends(const Ends& e, std::uint32_t begin, std::uint32_t end) {
  const T* const terms = reinterpret_cast<const T*>(e.terms);
  for (std::uint32_t n = begin; n < end; n++) {
    const std::uint32_t row = e.bodies[n], first = e.joints[row], last = e.joints[row + 1];
    if (first == last) continue;
    T sums[numbers] = {};
    for (std::uint32_t at = first; at < last; at++) {
      if ((e.joints[at] & 1) != e.side) continue;
      const T* const term = terms + (e.joints[at] >> 1) * std::size_t{numbers};
      for (std::uint32_t c = 0; c < numbers; c++) sums[c] += term[c];
    }
    T* const value = reinterpret_cast<T*>(e.column + row * e.stride);
    for (std::uint32_t c = 0; c < numbers; c++) value[c] += sums[c];
  }
}
using AddEnds = void (*)(const Ends&, std::uint32_t begin, std::uint32_t end);
template <class T> AddEnds add_ends_of(std::uint32_t numbers) {
  switch (numbers) {
    case 1: return add_ends<T, 1>;
    case 3: return add_ends<T, 3>;
    case 4: return add_ends<T, 4>;
    case 6: return add_ends<T, 6>;
    default: return add_ends<T, 9>;
  }
}
AddEnds add_ends_of(PropertyType type, std::size_t real_bytes) {
  if (type == PropertyType::int32) return add_ends<std::int32_t, 1>;
  if (type == PropertyType::uint32) return add_ends<std::uint32_t, 1>;
  const bool single = number_bytes(type, real_bytes) == 4;
  return single ? add_ends_of<float>(components(type)) : add_ends_of<double>(components(type));
}

}  // namespace

OwnRuns::Columns OwnRuns::columns(const OwnKernel& k, std::span<void* const> buffers, const std::byte* info) {
  Columns columns;
  for (std::size_t i = 0; i < k.arguments.size(); i++) {
    const OwnArgument& a = k.arguments[i];
    if (a.given) {
      std::size_t field = info_field::gravity_x;
      if (a.name == "h") field = k.once_a_step ? info_field::step : info_field::h;
      columns.at[i] = const_cast<std::byte*>(info) + field * k.real_bytes;
    } else if (!a.of_property()) {
      columns.at[i] = const_cast<std::byte*>(k.parameters.data()) + a.place;
    } else {
      columns.at[i] = static_cast<std::byte*>(buffers[std::size_t(a.buffer)]) + a.offset + (a.single ? a.row_bytes : 0);
      columns.strides[i] = a.single ? 0 : a.row_bytes;
    }
  }
  return columns;
}

void OwnRuns::reserve(const OwnKernel& k, std::size_t rows, Columns& columns) {
  constexpr std::size_t line = 64;  // of memory
  std::size_t bytes = 0;
  for (int pass = 0; pass < 2; pass++) {
    bytes = 0;
    for (std::size_t i = 0; i < k.arguments.size(); i++) {
      if (!k.arguments[i].summed()) continue;
      if (pass == 1) columns.totals[i] = sums_.data() + bytes;
      bytes += (rows * value_bytes(k.arguments[i], k.real_bytes) + line - 1) / line * line;
    }
    if (sums_.size() < bytes) sums_.resize(bytes);
  }
}

OwnRuns::Columns OwnRuns::terms(const OwnKernel& k, std::size_t rows, const Columns& columns) {
  Columns with = columns;
  for (std::size_t i = 0; i < k.arguments.size(); i++) {
    if (!k.arguments[i].summed()) continue;
    with.at[i] = columns.totals[i];
    with.strides[i] = value_bytes(k.arguments[i], k.real_bytes);
    std::memset(with.at[i], 0, rows * with.strides[i]);
  }
  return with;
}

void OwnRuns::join(const KernelRun& run, std::span<void* const> buffers, Columns& columns, const Workers* workers) {
  const OwnKernel& k = *run.own;
  const std::size_t rows = std::size_t{run.others} + 1;
  reserve(k, rows, columns);
  const Columns with = terms(k, rows, columns);
  std::array<std::uint8_t, OwnKernel::most_arguments> of_three{};
  for (std::size_t i = 0; i < k.arguments.size(); i++)  // terms stand by joint
    of_three[i] = k.arguments[i].summed() ? 0 : k.arguments[i].of_three();
  share(run.ranges[0], workers, [&](std::uint32_t begin, std::uint32_t end) {
    k.loop({with.at.data(), with.strides.data(), nullptr, begin, end, list(buffers, Buffer::joined), of_three.data()});
  });
  for (std::size_t i = 0; i < k.arguments.size(); i++) {
    const OwnArgument& a = k.arguments[i];
    if (!a.summed()) continue;
    const Ends ends{list(buffers, Buffer::bodies),
                    list(buffers, Buffer::body_joints),
                    with.at[i],
                    columns.at[i],
                    columns.strides[i],
                    a.of_three() - 1u};
    const AddEnds add = add_ends_of(a.type, k.real_bytes);
    share(run.ranges[1], workers, [&](std::uint32_t begin, std::uint32_t end) { add(ends, begin, end); });
  }
}

void OwnRuns::pairs(const KernelRun& run, std::span<void* const> buffers, Columns& columns, const Workers* workers) {
  const OwnKernel& k = *run.own;
  const bool of_bodies = k.table == Table::body;
  std::uint32_t end = 0;
  for (const Range& range : run.ranges) end = std::max(end, range.end);
  reserve(k, end, columns);
  KernelPairs pairs{.columns = columns.at.data(),
                    .strides = columns.strides.data(),
                    .totals = columns.totals.data(),
                    .apply = false,
                    .selves = of_bodies ? list(buffers, Buffer::bodies) : nullptr,
                    .begin = 0,
                    .end = 0,
                    .order = nullptr,
                    .places = nullptr,
                    .count = run.others,
                    .chunk = pair_chunk(run.others),
                    .first = nullptr,
                    .near = nullptr,
                    .centres = nullptr,
                    .centre_stride = 0,
                    .cutoff_squared = 0};
  if (k.cutoff) {
    pairs.first = list(buffers, Buffer::near_first);
    pairs.near = list(buffers, Buffer::near_rows);
    pairs.centres = static_cast<const std::byte*>(buffers[std::size_t(Buffer::pose)]);
    pairs.centre_stride = reals_of(Buffer::pose) * k.real_bytes;
    pairs.cutoff_squared = *k.cutoff * *k.cutoff;
  } else if (of_bodies) {
    pairs.places = list(buffers, Buffer::bodies_by_id);
    pairs.order = pairs.places + run.others + 1;
  }
  for (const bool apply : {false, true})  // everything is read before anything is written
    for (const Range& range : run.ranges)
      share(range, workers, [&](std::uint32_t begin, std::uint32_t stop) {
        KernelPairs part = pairs;
        part.apply = apply;
        part.begin = begin;
        part.end = stop;
        k.pairs(part);
      });
}

void OwnRuns::reduce(const KernelRun& run, std::span<void* const> buffers, Columns& columns, const Workers* workers) {
  const OwnKernel& k = *run.own;
  const std::uint32_t* rows = nullptr;
  if (k.table == Table::body) rows = list(buffers, Buffer::moving_by_id);
  if (k.table == Table::joint) rows = list(buffers, Buffer::joints_by_id);
  const Range range = run.ranges[0];
  const std::uint32_t count = range.end - range.begin;
  // values stand by row where they are made, then in the order of ids
  std::uint32_t most = 0;
  for (std::uint32_t n = range.begin; n < range.end; n++) most = std::max(most, rows ? rows[n] : n);
  reserve(k, 2 * (std::size_t{most} + 1), columns);
  const Columns with = terms(k, std::size_t{most} + 1, columns);
  share(range, workers, [&](std::uint32_t begin, std::uint32_t end) {
    k.loop({with.at.data(), with.strides.data(), rows, begin, end});
  });
  for (std::size_t i = 0; i < k.arguments.size(); i++) {
    const OwnArgument& a = k.arguments[i];
    if (!a.summed()) continue;
    const std::size_t bytes = with.strides[i];
    if (count == 0) {  // of nothing the sum is zero; there is no least and no most
      if (a.kind == OwnArgument::Kind::sum) std::memset(columns.at[i], 0, bytes);
      continue;
    }
    std::byte* const ordered = with.at[i] + (std::size_t{most} + 1) * bytes;
    for (std::uint32_t n = 0; n < count; n++)
      std::memcpy(ordered + n * bytes, with.at[i] + (rows ? rows[range.begin + n] : range.begin + n) * bytes, bytes);
    combine(a, k.real_bytes, ordered, count);
    std::memcpy(columns.at[i], ordered, bytes);
  }
}

void OwnRuns::run(const KernelRun& run, std::span<void* const> buffers, const std::byte* info, const Workers* workers) {
  const OwnKernel& k = *run.own;
  Columns at = columns(k, buffers, info);
  if (k.form == OwnKernel::Form::pair) return pairs(run, buffers, at, workers);
  if (k.form == OwnKernel::Form::joined) return join(run, buffers, at, workers);
  if (k.form == OwnKernel::Form::reduction) return reduce(run, buffers, at, workers);
  const std::uint32_t* rows = k.table == Table::body ? list(buffers, Buffer::bodies) : nullptr;
  for (const Range& range : run.ranges)
    share(range, workers, [&](std::uint32_t begin, std::uint32_t end) {
      k.loop({at.at.data(), at.strides.data(), rows, begin, end});
    });
}

}  // namespace pcphys
