// What the tests of the broad phase share: boxes, and random numbers.
#pragma once
#include <cstdint>
#include <limits>
#include <random>

#include "collision/aabb.h"

namespace broad_test {
using namespace pcphys;

inline constexpr float infinity = std::numeric_limits<float>::infinity();
inline constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

inline Aabb cube(float x, float y, float z, float half) {
  return {{x - half, y - half, z - half}, {x + half, y + half, z + half}};
}

struct Random {
  std::mt19937 engine;
  explicit Random(unsigned seed) : engine(seed) {}
  float operator()(float from, float to) { return std::uniform_real_distribution<float>(from, to)(engine); }
  std::uint32_t below(std::size_t end) { return static_cast<std::uint32_t>(engine() % end); }
};

}  // namespace broad_test
