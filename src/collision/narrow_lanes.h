// The narrow phase for many pairs of one kind, in lanes: the text of kernels/narrow, so the bits of `narrow`.
#pragma once
#include <cstdint>

#include "collision/manifold.h"

namespace pcphys {

/// Pairs that are done in lanes; others one by one.
enum class PairKind : std::uint8_t { spheres, capsules, other };
inline constexpr std::uint32_t lane_kinds = 2;
inline constexpr std::uint32_t round_reals = 16;  // of a shape's row

/// Pairs of one kind. Lists are padded to whole lanes, with any pair. A row of a shape: narrow_rows.inl.
template <class Scalar> struct PairBatch {
  const Scalar* rows;          // of shapes; 16-byte (double: 32-byte) aligned
  const std::uint32_t *a, *b;  // rows of the pairs' shapes
  const Scalar* margins;       // as that of `narrow`; aligned to whole lanes
  std::uint32_t count;
};

/// Writes the manifolds of pairs within their margins, as seen from a's body, and their places in the batch, in ascending
/// order; returns how many. `out` and `places` have room for all pairs.
template <class Scalar>
using NarrowBatch = std::uint32_t (*)(const PairBatch<Scalar>&, Manifold<Scalar>* out, std::uint32_t* places);

template <class Scalar> struct NarrowLanes {
  std::uint32_t lanes;
  NarrowBatch<Scalar> run[lane_kinds];  // by PairKind
};

extern const NarrowLanes<float> narrow_lanes_f1;
extern const NarrowLanes<double> narrow_lanes_d1;
#ifdef PCPHYS_HAVE_X86_LANES
extern const NarrowLanes<float> narrow_lanes_f4, narrow_lanes_f8;
extern const NarrowLanes<double> narrow_lanes_d4;
#endif

/// Those of that many lanes; 0, or what the processor has not: the widest that it has.
template <class Scalar> const NarrowLanes<Scalar>& narrow_lanes(std::uint32_t lanes);

}  // namespace pcphys
