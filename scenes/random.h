// The generator of random numbers of all scenes: Knuth's 64-bit linear congruence (MMIX), its upper 24 bits.
// The peers' scenes draw from the same one, so equal seeds give equal scenes.
#pragma once
#include <cstdint>

namespace pcphys::scenes {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// The next number in [low, high).
  double between(double low, double high) {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return low + (high - low) * (double(state_ >> 40) / 16777216.0);
  }

 private:
  std::uint64_t state_;
};

}  // namespace pcphys::scenes
