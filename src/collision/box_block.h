// Up to four boxes side by side, so that one box is tested against all of them at once.
#pragma once
#include <cstdint>
#include <limits>
#include <span>

#include "collision/aabb.h"

namespace pcphys {

struct alignas(16) BoxBlock {
  static constexpr std::uint32_t lanes = 4, all = 15;

  float min[3][lanes], max[3][lanes];  // NaN in unused lanes: they overlap nothing, not even infinite boxes
  std::uint32_t index[lanes];
  std::uint32_t count;
  std::uint32_t still, mobile;  // a bit per lane, see KdTree::Flag

  Aabb box(std::uint32_t lane) const {
    return {{min[0][lane], min[1][lane], min[2][lane]}, {max[0][lane], max[1][lane], max[2][lane]}};
  }
  std::uint32_t used() const { return (1u << count) - 1; }
  std::uint32_t moved() const { return ~still & used(); }

  /// Copies the boxes of index[0] ... index[count - 1] and returns the box around them.
  Aabb load(std::span<const Aabb> boxes);
};
static_assert(sizeof(BoxBlock) == 128);

/// Bit l is set when lane l of `block` overlaps the box with these sides.
inline std::uint32_t overlapping_lanes(const BoxBlock& block, float x0, float y0, float z0, float x1, float y1, float z1) {
#if defined(__SSE2__)
  const auto below = [](const float* lanes, float side) { return _mm_cmple_ps(_mm_load_ps(lanes), _mm_set1_ps(side)); };
  const auto above = [](const float* lanes, float side) { return _mm_cmpge_ps(_mm_load_ps(lanes), _mm_set1_ps(side)); };
  const __m128 x = _mm_and_ps(below(block.min[0], x1), above(block.max[0], x0));
  const __m128 y = _mm_and_ps(below(block.min[1], y1), above(block.max[1], y0));
  const __m128 z = _mm_and_ps(below(block.min[2], z1), above(block.max[2], z0));
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_and_ps(_mm_and_ps(x, y), z)));
#else
  std::uint32_t bits = 0;
  for (std::uint32_t l = 0; l < BoxBlock::lanes; ++l)
    bits |= static_cast<std::uint32_t>(block.min[0][l] <= x1 && block.max[0][l] >= x0 && block.min[1][l] <= y1 &&
                                       block.max[1][l] >= y0 && block.min[2][l] <= z1 && block.max[2][l] >= z0) << l;
  return bits;
#endif
}

inline std::uint32_t overlapping_lanes(const BoxBlock& block, const float* min, const float* max) {
  return overlapping_lanes(block, min[0], min[1], min[2], max[0], max[1], max[2]);
}

/// The same for one lane of another block.
inline std::uint32_t overlapping_lanes(const BoxBlock& block, const BoxBlock& other, std::uint32_t lane) {
  return overlapping_lanes(block, other.min[0][lane], other.min[1][lane], other.min[2][lane], other.max[0][lane],
                           other.max[1][lane], other.max[2][lane]);
}

inline Aabb BoxBlock::load(std::span<const Aabb> boxes) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  static constexpr Aabb nothing{{nan, nan, nan}, {nan, nan, nan}};
  const Aabb* source[lanes];
  for (std::uint32_t l = 0; l < lanes; ++l) source[l] = l < count ? &boxes[index[l]] : &nothing;
  Aabb around = *source[0];
#if defined(__SSE2__)
  __m128 low[lanes], high[lanes];  // min0 min1 min2 max0; min2 max0 max1 max2
  for (std::uint32_t l = 0; l < lanes; ++l) low[l] = _mm_loadu_ps(source[l]->min), high[l] = _mm_loadu_ps(source[l]->min + 2);
  __m128 least = low[0], most = high[0];  // the second operand survives a NaN
  for (std::uint32_t l = 1; l < lanes; ++l) least = _mm_min_ps(low[l], least), most = _mm_max_ps(high[l], most);
  _mm_storeu_ps(around.min + 2, most);
  _mm_storel_pi(reinterpret_cast<__m64*>(around.min), least);
  _mm_store_ss(around.min + 2, _mm_movehl_ps(least, least));
  _MM_TRANSPOSE4_PS(low[0], low[1], low[2], low[3]);
  _MM_TRANSPOSE4_PS(high[0], high[1], high[2], high[3]);
  for (int k = 0; k < 3; ++k) _mm_store_ps(min[k], low[k]), _mm_store_ps(max[k], high[k + 1]);
#else
  for (int k = 0; k < 3; ++k)
    for (std::uint32_t l = 0; l < lanes; ++l) min[k][l] = source[l]->min[k], max[k][l] = source[l]->max[k];
  for (int k = 0; k < 3; ++k)
    for (std::uint32_t l = 1; l < count; ++l)
      around.min[k] = std::min(around.min[k], min[k][l]), around.max[k] = std::max(around.max[k], max[k][l]);
#endif
  return around;
}

}  // namespace pcphys
