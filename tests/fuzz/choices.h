// Where a random sequence of calls takes its decisions from: a seed, or the bytes that a fuzzer gives.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "pcphys/math.h"

namespace fuzz {

using pcphys::Quat;
using pcphys::Vec3;

class Choices {
 public:
  /// SplitMix64 (G. Steele, D. Lea, C. Flood, 2014).
  explicit Choices(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15ull) {}
  /// Bytes while there are any, then zeros.
  explicit Choices(std::span<const std::uint8_t> bytes) : bytes_(bytes), of_bytes_(true) {}

  bool over() const { return of_bytes_ && bytes_.empty(); }
  std::uint64_t next() {
    if (of_bytes_) return take(8);
    state_ += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  /// One of 0 to count - 1.
  std::uint32_t below(std::uint32_t count) {
    return std::uint32_t((of_bytes_ ? take(count > 256 ? 4 : 1) : next()) % count);
  }
  bool chance(double share) { return between(0, 1) < share; }
  double between(double low, double high) {
    const double x = of_bytes_ ? double(take(2)) * 0x1p-16 : double(next() >> 11) * 0x1p-53;
    return low + (high - low) * x;
  }
  double by_ratio(double low, double high) { return low * std::exp(between(0, std::log(high / low))); }

  /// What hosts hand in by mistake: NaN, infinities, zeros of either sign, the ends of what numbers can be.
  double odd() {
    using Limits = std::numeric_limits<double>;
    constexpr std::array odd{Limits::quiet_NaN(),
                             Limits::infinity(),
                             -Limits::infinity(),
                             0.0,
                             -0.0,
                             1e-320,
                             1e-45,
                             1e-30,
                             -1.0,
                             1e15,
                             -1e15,
                             1e30,
                             3e38,
                             1e39,
                             Limits::max()};
    return chance(0.3) ? by_ratio(1e-300, 1e300) * (chance(0.5) ? 1 : -1) : odd[below(odd.size())];
  }
  /// Within the bounds but for one in `rarity_`.
  double number(double low, double high) { return rare() ? odd() : between(low, high); }
  double ratio(double low, double high) { return rare() ? odd() : by_ratio(low, high); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Quat turn() {
    if (rare()) return {odd(), odd(), odd(), odd()};
    const Quat q{between(-1, 1), between(-1, 1), between(-1, 1), between(-1, 1)};
    const double squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (squared < 1e-4 || chance(0.3)) return {};
    const double s = 1 / std::sqrt(squared);
    return {q.x * s, q.y * s, q.z * s, q.w * s};
  }
  /// How many numbers there are to one that is odd; 0: none is.
  void set_rarity(std::uint32_t rarity) { rarity_ = rarity; }

 private:
  bool rare() { return rarity_ > 0 && below(rarity_) == 1; }
  std::uint64_t take(std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count && !bytes_.empty(); i++, bytes_ = bytes_.subspan(1))
      value = value << 8 | bytes_[0];
    return value;
  }

  std::uint64_t state_ = 0;
  std::span<const std::uint8_t> bytes_;
  bool of_bytes_ = false;
  std::uint32_t rarity_ = 0;
};

}  // namespace fuzz
