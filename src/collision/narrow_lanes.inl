// Instantiates the narrow phase of pairs in PC_LANES lanes of PC_SCALAR: loops and copies, no arithmetic.
#include "collision/narrow_lanes.h"
#include "cpu/prelude.h"

namespace pcphys {
namespace PC_NAMESPACE {
#include "kernels/narrow/narrow_lines.inl"
#include "kernels/narrow/narrow_rows.inl"

#if PC_LANES == 1
PC_INLINE uint pc_mask_bits(Mask m) { return m; }
#endif

struct Lanes {
  alignas(64) Scalar v[PC_LANES];
};
PC_INLINE void pc_put(Lanes* to, Vec3 x) {
  pc_store(to[0].v, x.x);
  pc_store(to[1].v, x.y);
  pc_store(to[2].v, x.z);
}
// Of the first `count` lanes, those that are not apart.
PC_INLINE uint pc_hand_out(const RoundContact& c, uint first, uint count, Manifold<Scalar>* out, uint* places) {
  const uint two = pc_mask_bits(c.two), all = count < PC_LANES ? (1u << count) - 1u : (1u << PC_LANES) - 1u;
  uint near = all & ~pc_mask_bits(c.apart), n = 0;
  if (near == 0) return 0;
  Lanes normal[3], p[3], separation, feature, second[3], second_separation;
  pc_put(normal, c.normal);
  pc_put(p, c.p);
  pc_store(separation.v, c.separation);
  pc_store(feature.v, c.feature);
  pc_put(second, c.second);
  pc_store(second_separation.v, c.second_separation);
  for (; near != 0; near &= near - 1u) {
    const uint l = uint(__builtin_ctz(near));
    Manifold<Scalar>& m = out[n];
    places[n++] = first + l;
    ManifoldPoint<Scalar>* point = m.points;
    for (uint k = 0; k < 3; k++) m.normal[k] = normal[k].v[l], point->p[k] = p[k].v[l];
    point->separation = separation.v[l];
    point->feature = uint(int(feature.v[l]));
    m.count = 1;
    if ((two >> l & 1u) == 0) continue;
    m.count = 2;
    point++;
    for (uint k = 0; k < 3; k++) point->p[k] = second[k].v[l];
    point->separation = second_separation.v[l];
    point->feature = 2;
  }
  return n;
}

#define PC_BATCH(name, pairs)                                                                                  \
  static uint name(const PairBatch<Scalar>& batch, Manifold<Scalar>* out, uint* places) {                      \
    uint n = 0;                                                                                                \
    for (uint i = 0; i < batch.count; i += PC_LANES) {                                                         \
      const RoundPair pair = pc_round_pair(pc_row(batch.rows, pc_index(batch.a + i), quads_round),             \
                                           pc_row(batch.rows, pc_index(batch.b + i), quads_round));            \
      n += pc_hand_out(pairs(pair.a, pair.b, pc_load(batch.margins + i)), i, batch.count - i, out + n, places + n); \
    }                                                                                                          \
    return n;                                                                                                  \
  }
PC_BATCH(spheres, pc_spheres)
PC_BATCH(capsules, pc_capsules)
#undef PC_BATCH
}  // namespace PC_NAMESPACE

const NarrowLanes<PC_SCALAR> PC_EXPORT = {PC_LANES, {PC_NAMESPACE::spheres, PC_NAMESPACE::capsules}};

}  // namespace pcphys
