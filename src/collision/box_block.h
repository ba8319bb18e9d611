// Up to four boxes side by side, so that one box is tested against all of them at once. The boxes are those
// of objects, or of subtrees that other blocks hold.
#pragma once
#include <cstdint>
#include <limits>

#include "collision/aabb.h"

namespace pcphys {

struct alignas(16) BoxBlock {
  static constexpr std::uint32_t lanes = 4, all = 15;

  float min[3][lanes], max[3][lanes];  // NaN in unused lanes: they overlap nothing, not even infinite boxes
  std::uint32_t index[lanes];          // of the object in a leaf, of a block otherwise
  std::uint8_t count, leaf;
  std::uint8_t still, moved, mobile;  // a bit per lane, see KdTree::Flag; a subtree may have all of them

  Aabb box(std::uint32_t lane) const {
    return {{min[0][lane], min[1][lane], min[2][lane]}, {max[0][lane], max[1][lane], max[2][lane]}};
  }
  bool moved_at(std::uint32_t lane) const { return moved >> lane & 1; }
  bool mobile_at(std::uint32_t lane) const { return mobile >> lane & 1; }
  /// Lanes that may pair with something of these flags: one of the two has moved, one is mobile.
  std::uint32_t allowed(bool with_moved, bool with_mobile) const {
    return (with_moved ? all : moved) & (with_mobile ? all : mobile);
  }
  /// Copies the `count` boxes boxes[index[lane]] and returns the box around them.
  Aabb load(const Aabb* boxes);
};
static_assert(sizeof(BoxBlock) == 128);

/// Bit l is set when lane l of `block` overlaps the box with these sides.
inline std::uint32_t overlapping_lanes(const BoxBlock& block, float x0, float y0, float z0, float x1, float y1,
                                       float z1) {
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
                                       block.max[1][l] >= y0 && block.min[2][l] <= z1 && block.max[2][l] >= z0)
            << l;
  return bits;
#endif
}

inline std::uint32_t overlapping_lanes(const BoxBlock& block, const Aabb& box) {
  return overlapping_lanes(block, box.min[0], box.min[1], box.min[2], box.max[0], box.max[1], box.max[2]);
}

/// The same for one lane of another block.
inline std::uint32_t overlapping_lanes(const BoxBlock& block, const BoxBlock& other, std::uint32_t lane) {
  return overlapping_lanes(block, other.min[0][lane], other.min[1][lane], other.min[2][lane], other.max[0][lane],
                           other.max[1][lane], other.max[2][lane]);
}

inline Aabb BoxBlock::load(const Aabb* boxes) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  static constexpr Aabb nothing{{nan, nan, nan}, {nan, nan, nan}};
  const Aabb* source[lanes];
  for (std::uint32_t l = 0; l < lanes; ++l) source[l] = l < count ? &boxes[index[l]] : &nothing;
  Aabb around = *source[0];
#if defined(__SSE2__)
  __m128 low[lanes], high[lanes];  // min0 min1 min2 max0; min2 max0 max1 max2
  for (std::uint32_t l = 0; l < lanes; ++l)
    low[l] = _mm_loadu_ps(source[l]->min), high[l] = _mm_loadu_ps(source[l]->min + 2);
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
