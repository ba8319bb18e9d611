// What the detector does in lanes: the narrow phase for many pairs of one kind, with the text of kernels/narrow and so
// the bits of `narrow`; and how bodies move and the boxes of shapes.
#pragma once
#include <cstdint>

#include "collision/manifold.h"

namespace pcphys {

struct Aabb;

/// Pairs that are done in lanes; others one by one.
enum class PairKind : std::uint8_t { spheres, capsules, sphere_box, capsule_box, other };
inline constexpr std::uint32_t lane_kinds = 4;
inline constexpr std::uint32_t round_reals = 16, bound_columns = 9;  // of a shape: narrow_bounds.inl

/// Pairs of one kind. Lists are padded to whole lanes, with any pair. A row of a shape: narrow_bounds.inl.
template <class Scalar> struct PairBatch {
  const Scalar* rows;          // of shapes; 16-byte (double: 32-byte) aligned
  const std::uint32_t *a, *b;  // rows of the pairs' shapes
  const Scalar* margins;       // as that of `narrow`; aligned to whole lanes
  std::uint32_t count;
};

/// Writes the manifolds of pairs within their margins, as seen from a's body, and their places in the batch, in
/// ascending order; returns how many. One without points: the pair is for `narrow`.
/// `out` and `places` have room for all pairs.
template <class Scalar>
using NarrowBatch = std::uint32_t (*)(const PairBatch<Scalar>&, Manifold<Scalar>* out, std::uint32_t* places);

/// How bodies move, into rows of 12: TwistOf. `rows` is padded to whole lanes with 0, the row of the ground.
template <class Scalar> struct TwistCall {
  const Scalar *motion, *mass, *pose;  // tables
  const std::uint32_t* rows;
  std::uint32_t count;
  Scalar* twists;
};

/// How far shapes may come in the step, and their boxes; all lists are padded to whole lanes.
struct BoxCall {
  const float *rows, *columns, *twists;  // narrow_bounds.inl; column k begins at k stride
  const std::uint32_t* bodies;           // rows
  std::uint32_t count, stride;
  float step, fall, largest_turn;  // [s, m, rad]
  float* reach;                    // [m]
  Aabb* boxes;
};

template <class Scalar> struct NarrowLanes {
  std::uint32_t lanes;
  void (*twists)(const TwistCall<Scalar>&);
  void (*boxes)(const BoxCall&);        // in float alone, as boxes are in both precisions
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
