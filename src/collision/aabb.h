// Axis-aligned boxes. Always float, whatever the precision of the world: the caller rounds outward
// (`round_down`, `round_up`), so that a box never loses a point of its shape.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace pcphys {

/// Metres, world axes. Infinite sides are allowed (planes). A box with a NaN or with min > max is no box.
struct Aabb {
  float min[3], max[3];
};
static_assert(sizeof(Aabb) == 24);

/// The largest float that is not above x, and the smallest that is not below it; NaN stays NaN.
/// Without branches, which could not be predicted: bits of floats as integers in the same order.
inline float round_down(double x) {
  const float f = static_cast<float>(x);
  const auto ordered = [](std::int32_t bits) { return bits ^ ((bits >> 31) & 0x7fffffff); };
  return std::bit_cast<float>(ordered(ordered(std::bit_cast<std::int32_t>(f)) - std::int32_t(f > x)));
}
inline float round_up(double x) { return -round_down(-x); }

/// False for NaN and for inverted boxes.
inline bool valid(const Aabb& box) {
  return box.min[0] <= box.max[0] && box.min[1] <= box.max[1] && box.min[2] <= box.max[2];
}

inline bool bounded(const Aabb& box) {
  constexpr float largest = std::numeric_limits<float>::max();
  bool in = true;
  for (int i = 0; i < 3; ++i) in &= box.min[i] >= -largest && box.max[i] <= largest;
  return in;
}

/// Boxes that only touch do overlap.
inline bool overlap(const Aabb& a, const Aabb& b) {
#if defined(__SSE2__)
  // Lanes min0 min1 min2 - against max0 max1 max2 -: without branches, which could not be predicted.
  const auto high = [](const Aabb& box) {
    const __m128 x = _mm_loadu_ps(box.min + 2);
    return _mm_shuffle_ps(x, x, _MM_SHUFFLE(3, 3, 2, 1));
  };
  const __m128 ab = _mm_cmple_ps(_mm_loadu_ps(a.min), high(b)), ba = _mm_cmple_ps(_mm_loadu_ps(b.min), high(a));
  return (_mm_movemask_ps(_mm_and_ps(ab, ba)) & 7) == 7;
#else
  return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] && b.min[1] <= a.max[1] &&
         a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
#endif
}

/// False when either is no box.
inline bool contains(const Aabb& outer, const Aabb& inner) {
#if defined(__SSE2__)
  // Lanes min0 min1 min2 max0 and min2 max0 max1 max2.
  const __m128 low = _mm_cmpge_ps(_mm_loadu_ps(inner.min), _mm_loadu_ps(outer.min));
  const __m128 high = _mm_cmple_ps(_mm_loadu_ps(inner.min + 2), _mm_loadu_ps(outer.min + 2));
  return ((_mm_movemask_ps(low) | 8) & (_mm_movemask_ps(high) | 1)) == 15;
#else
  return inner.min[0] >= outer.min[0] && inner.max[0] <= outer.max[0] && inner.min[1] >= outer.min[1] &&
         inner.max[1] <= outer.max[1] && inner.min[2] >= outer.min[2] && inner.max[2] <= outer.max[2];
#endif
}

inline Aabb grown(const Aabb& box, float margin) {
  return {{box.min[0] - margin, box.min[1] - margin, box.min[2] - margin},
          {box.max[0] + margin, box.max[1] + margin, box.max[2] + margin}};
}

inline float largest_side(const Aabb& box) {
  return std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
}

}  // namespace pcphys
