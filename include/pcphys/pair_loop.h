// The C++ side of pair kernels (write_kernel.h): loops over bodies and, of each, over the others, in an order of sums
// that the GPU keeps too. Lanes are bodies side by side, for the compiler to vectorise;
// each lane sums in the order of one alone.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "pcphys/kernel.h"

namespace pcphys::detail {

template <class T> T load(const std::byte* p) {
  T value;
  std::memcpy(&value, p, sizeof value);
  return value;
}

enum class PairArgument : std::uint8_t { self, other, parameter, sum, add };
/// Of the arguments of a signature, in its order.
template <std::size_t Count> consteval std::array<PairArgument, Count> pair_arguments(std::string_view signature) {
  std::array<PairArgument, Count> found{};
  std::size_t at = 0;
  for (PairArgument& argument : found) {
    at = signature.find("PC_", at) + 3;
    const std::string_view word = signature.substr(at);
    argument = word.starts_with("SELF")    ? PairArgument::self
               : word.starts_with("OTHER") ? PairArgument::other
               : word.starts_with("PARAM") ? PairArgument::parameter
               : word.starts_with("ADD")   ? PairArgument::add
                                           : PairArgument::sum;
  }
  return found;
}

/// Values of `Width` lanes, component by component.
template <class T, class Real, std::size_t Width> struct LaneValues {
  using Number = std::conditional_t<std::is_arithmetic_v<T>, T, Real>;
  static constexpr std::size_t count = sizeof(T) / sizeof(Number);
  using Numbers = std::array<Number, count>;
  alignas(64) Number x[count][Width];

  T at(std::size_t lane) const {
    Numbers numbers;
    for (std::size_t c = 0; c < count; c++) numbers[c] = x[c][lane];
    return std::bit_cast<T>(numbers);
  }
  void set(std::size_t lane, const T& value) {
    const auto numbers = std::bit_cast<Numbers>(value);
    for (std::size_t c = 0; c < count; c++) x[c][lane] = numbers[c];
  }
  void clear() { std::memset(x, 0, sizeof x); }
  void add(std::size_t lane, const T& value) {
    const auto numbers = std::bit_cast<Numbers>(value);
    for (std::size_t c = 0; c < count; c++) x[c][lane] += numbers[c];
  }
  void add(const LaneValues& other) {
    for (std::size_t c = 0; c < count; c++)
      for (std::size_t lane = 0; lane < Width; lane++) x[c][lane] += other.x[c][lane];
  }
};

template <auto Run, auto Kinds, class Real, class = decltype(Run)> struct PairLoop;
template <auto Run, auto Kinds, class Real, class... Arguments>
struct PairLoop<Run, Kinds, Real, void (*)(Arguments...)> {
  static void run(const KernelPairs& k) {
    constexpr auto indices = std::index_sequence_for<Arguments...>();
    if (k.apply)
      for (std::uint32_t n = k.begin; n < k.end; n++) apply(k, n, indices);
    else if (k.first)
      for (std::uint32_t n = k.begin; n < k.end; n++) near(k, n, indices);
    else
      for (std::uint32_t n = k.begin; n < k.end; n += width) all(k, n, std::min(k.end - n, width), indices);
  }

 private:
  static constexpr std::uint32_t width = 16;
  static constexpr std::uint32_t tile = KernelPairs::tile;
  struct Nothing {};
  using Values = std::tuple<std::remove_cvref_t<Arguments>...>;
  template <std::size_t I> using Value = std::tuple_element_t<I, Values>;
  template <class T> using Lanes = LaneValues<T, Real, width>;
  static constexpr bool of_self(std::size_t i) { return Kinds[i] == PairArgument::self; }
  static constexpr bool summed(std::size_t i) { return Kinds[i] >= PairArgument::sum; }
  template <std::size_t... I>
  static std::tuple<std::conditional_t<of_self(I), Lanes<Value<I>>, Nothing>...> selves_of(std::index_sequence<I...>);
  template <std::size_t... I>
  static std::tuple<std::conditional_t<summed(I), Lanes<Value<I>>, Nothing>...> sums_of(std::index_sequence<I...>);
  using Selves = decltype(selves_of(std::index_sequence_for<Arguments...>()));
  using Sums = decltype(sums_of(std::index_sequence_for<Arguments...>()));

  static std::uint32_t self(const KernelPairs& k, std::uint32_t n) { return k.selves ? k.selves[n] : n; }
  template <std::size_t I> static std::byte* place(const KernelPairs& k, std::size_t row) {
    return k.columns[I] + row * k.strides[I];
  }
  template <std::size_t I> static std::byte* total(const KernelPairs& k, std::size_t n) {
    return k.totals[I] + n * sizeof(Value<I>);
  }
  template <std::size_t I> static void keep(const KernelPairs& k, std::uint32_t n, const Value<I>& value) {
    if constexpr (summed(I)) std::memcpy(total<I>(k, n), &value, sizeof value);
  }

  // ---- all others ---------------------------------------------------------------------------------------
  template <std::size_t I>
  static void set(Selves& selves, const KernelPairs& k, std::uint32_t row, std::uint32_t lane) {
    if constexpr (of_self(I)) std::get<I>(selves).set(lane, load<Value<I>>(place<I>(k, row)));
  }
  template <std::size_t I> static void clear(Sums& sums) {
    if constexpr (summed(I)) std::get<I>(sums).clear();
  }
  template <std::size_t I> static void add(Sums& sums, const Sums& more) {
    if constexpr (summed(I)) std::get<I>(sums).add(std::get<I>(more));
  }
  template <std::size_t I> static void add(Sums& sums, const Values& terms, std::size_t lane) {
    if constexpr (summed(I)) std::get<I>(sums).add(lane, std::get<I>(terms));
  }
  template <std::size_t I> static Value<I> argument(const Values& other, const Selves& selves, std::size_t lane) {
    if constexpr (of_self(I))
      return std::get<I>(selves).at(lane);
    else
      return std::get<I>(other);
  }
  template <std::size_t I> static Value<I> of_other(const KernelPairs& k, std::uint32_t row) {
    if constexpr (of_self(I) || summed(I))
      return {};
    else
      return load<Value<I>>(place<I>(k, row));
  }
  template <std::size_t I>
  static void keep_lane(const KernelPairs& k, std::uint32_t n, const Sums& sums, std::uint32_t lane) {
    if constexpr (summed(I)) keep<I>(k, n + lane, std::get<I>(sums).at(lane));
  }

  /// Of `lanes` bodies from n on the terms of all others: summed in a row within a tile, then tiles within a chunk,
  /// then chunks by a binary tree.
  template <std::size_t... I>
  static void all(const KernelPairs& k, std::uint32_t n, std::uint32_t lanes, std::index_sequence<I...> indices) {
    Selves selves;
    std::uint32_t places[width];
    for (std::uint32_t lane = 0; lane < width; lane++) {
      const std::uint32_t row = self(k, n + std::min(lane, lanes - 1));
      places[lane] = k.places ? k.places[row] : row - 1;
      (set<I>(selves, k, row, lane), ...);
    }
    std::array<Sums, KernelPairs::most_chunks> parts;
    std::uint32_t chunks = 0;
    for (std::uint32_t begin = 0; begin < k.count; begin += k.chunk, chunks++) {
      (clear<I>(parts[chunks]), ...);
      const std::uint32_t end = std::min(k.count, begin + k.chunk);
      for (std::uint32_t at = begin; at < end; at += tile) {
        const std::uint32_t count = std::min(end - at, tile);
        Sums sums;
        (clear<I>(sums), ...);
        // hardly any tile has one of them among the others; without the question a compiler vectorises
        if (std::ranges::any_of(places, [&](std::uint32_t p) { return p - at < count; }))
          add_tile<true>(k, at, count, selves, places, sums, indices);
        else
          add_tile<false>(k, at, count, selves, places, sums, indices);
        (add<I>(parts[chunks], sums), ...);
      }
    }
    for (std::uint32_t step = 1; step < chunks; step *= 2)
      for (std::uint32_t c = 0; c + step < chunks; c += 2 * step) (add<I>(parts[c], parts[c + step]), ...);
    for (std::uint32_t lane = 0; lane < lanes; lane++) (keep_lane<I>(k, n, parts[0], lane), ...);
  }

  template <bool skips, std::size_t... I>
  static void add_tile(const KernelPairs& k, std::uint32_t first, std::uint32_t count, const Selves& selves,
                       const std::uint32_t (&places)[width], Sums& sums, std::index_sequence<I...>) {
    for (std::uint32_t j = first; j < first + count; j++) {
      const Values other{of_other<I>(k, k.order ? k.order[j] : j + 1)...};
      for (std::uint32_t lane = 0; lane < width; lane++) {
        if (skips && places[lane] == j) continue;
        Values terms{argument<I>(other, selves, lane)...};
        Run(std::get<I>(terms)...);
        (add<I>(sums, terms, lane), ...);
      }
    }
  }

  // ---- those within a cut-off ---------------------------------------------------------------------------
  static bool within(const KernelPairs& k, std::uint32_t row, std::uint32_t other) {
    using Place = std::array<Real, 3>;
    const auto a = load<Place>(k.centres + row * k.centre_stride), b = load<Place>(k.centres + other * k.centre_stride);
    const Real x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return x * x + y * y + z * z <= Real(k.cutoff_squared);
  }
  template <std::size_t I> static Value<I> argument(const KernelPairs& k, std::uint32_t row, std::uint32_t other) {
    if constexpr (summed(I))
      return {};
    else
      return load<Value<I>>(place<I>(k, of_self(I) ? row : other));
  }
  template <std::size_t I> static void add(Values& sums, const Values& terms) {
    using Single = LaneValues<Value<I>, Real, 1>;
    if constexpr (summed(I)) {
      Single sum, term;
      sum.set(0, std::get<I>(sums));
      term.set(0, std::get<I>(terms));
      sum.add(term);
      std::get<I>(sums) = sum.at(0);
    }
  }
  template <std::size_t... I> static void near(const KernelPairs& k, std::uint32_t n, std::index_sequence<I...>) {
    const std::uint32_t row = self(k, n);
    Values sums{};
    for (std::uint32_t at = k.first[row]; at < k.first[row + 1]; at++) {
      const std::uint32_t other = k.near[at];
      if (!within(k, row, other)) continue;
      Values terms{argument<I>(k, row, other)...};
      Run(std::get<I>(terms)...);
      (add<I>(sums, terms), ...);
    }
    (keep<I>(k, n, std::get<I>(sums)), ...);
  }

  // ---- what was summed, into properties -----------------------------------------------------------------
  template <std::size_t I> static void apply_one(const KernelPairs& k, std::uint32_t n) {
    if constexpr (summed(I)) {
      LaneValues<Value<I>, Real, 1> value, sum;
      std::byte* const target = place<I>(k, self(k, n));
      sum.set(0, load<Value<I>>(total<I>(k, n)));
      if (Kinds[I] == PairArgument::add) {
        value.set(0, load<Value<I>>(target));
        value.add(sum);
      } else {
        value = sum;
      }
      const Value<I> result = value.at(0);
      std::memcpy(target, &result, sizeof result);
    }
  }
  template <std::size_t... I> static void apply(const KernelPairs& k, std::uint32_t n, std::index_sequence<I...>) {
    (apply_one<I>(k, n), ...);
  }
};

}  // namespace pcphys::detail
