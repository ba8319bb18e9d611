// Random draws of the wild scenes: a function of family and seed alone.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "pcphys/math.h"

namespace pcphys::wild {

/// SplitMix64 (G. Steele, D. Lea, C. Flood, 2014). A family's scenes are unrelated to those of another with the same
/// seed.
class Dice {
 public:
  Dice(std::string_view family, std::uint64_t seed) : state_(14695981039346656037ull) {
    for (const char c : family) state_ = (state_ ^ std::uint64_t(static_cast<unsigned char>(c))) * 1099511628211ull;
    state_ ^= seed * 0x9e3779b97f4a7c15ull;
    (void)next();
  }

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }

  /// In [low, high).
  double between(double low, double high) { return low + (high - low) * double(next() >> 11) * 0x1p-53; }
  /// The same with equal chances for equal ratios; both bounds above zero.
  double by_ratio(double low, double high) { return low * std::exp(between(0, std::log(high / low))); }
  /// One of 0 to count - 1.
  int one_of(int count) { return int(next() % std::uint64_t(count)); }
  bool chance(double share) { return between(0, 1) < share; }
  template <class T> const T& one_of(std::span<const T> list) { return list[std::size_t(one_of(int(list.size())))]; }

  /// Uniform on the unit sphere.
  Vec3 direction() {
    while (true) {
      const Vec3 v{between(-1, 1), between(-1, 1), between(-1, 1)};
      const double squared = dot(v, v);
      if (squared > 1e-4 && squared <= 1) return v * (1 / std::sqrt(squared));
    }
  }
  /// Uniform over all orientations.
  Quat orientation() {
    while (true) {
      const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1), w = between(-1, 1);
      const double squared = x * x + y * y + z * z + w * w;
      if (squared < 1e-4 || squared > 1) continue;
      const double scale = 1 / std::sqrt(squared);
      return {x * scale, y * scale, z * scale, w * scale};
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace pcphys::wild
