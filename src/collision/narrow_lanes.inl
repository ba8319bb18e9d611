// Instantiates what the detector does in PC_LANES lanes of PC_SCALAR: loops and copies, no arithmetic.
#include "collision/aabb.h"
#include "collision/narrow_lanes.h"
#include "cpu/prelude.h"

namespace pcphys {
namespace PC_NAMESPACE {
#include "kernels/narrow/narrow_lines.inl"
#include "kernels/narrow/narrow_over_box.inl"
#include "kernels/narrow/narrow_bounds.inl"
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

static void twists(const TwistCall<Scalar>& call) {
  for (uint i = 0; i < call.count; i += PC_LANES) {
    const Index row = pc_index(call.rows + i);
    const Row motion = pc_row(call.motion, row, 2);
    const Quad facing = pc_gather(call.pose, row, 4, 1);
    const BodyMotion m = pc_body_motion(pc_row_quad(motion, 0).v, pc_row_quad(motion, 1).v,
                                        pc_gather(call.mass, row, 2, 1).v, pc_quaternion(facing.v, facing.s));
    pc_scatter(call.twists, row, 3, 0, pc_quad(m.v, m.speed));
    pc_scatter(call.twists, row, 3, 1, pc_quad(m.w, m.turn));
    pc_scatter(call.twists, row, 3, 2, pc_quad(Vec3(m.across, PC_REAL(0), PC_REAL(0)), PC_REAL(0)));
  }
}

#ifndef PC_DOUBLE  // boxes are in float in both precisions
static void boxes(const BoxCall& call) {
  const Stride stride = {PC_REAL(call.step), PC_REAL(call.fall), PC_REAL(call.largest_turn)};
  for (uint i = 0; i < call.count; i += PC_LANES) {
    const auto column = [&](uint k) { return pc_load(call.columns + std::size_t(k) * call.stride + i); };
    Row shape;
    for (uint l = 0; l < PC_LANES; l++) shape.p[l] = call.rows + std::size_t(i + l) * (quads_round * 4);
    const Row twist = pc_row(call.twists, pc_index(call.bodies + i), 3);
    const Real speed = pc_row_quad(twist, 0).s, turn = pc_row_quad(twist, 1).s, across = pc_row_quad(twist, 2).v.x;
    const Real reach = pc_shape_reach(stride, speed, turn, across, column(BOUND_ACROSS), column(BOUND_ANY),
                                      column(BOUND_MOVES), column(BOUND_WENT));
    const Quad facing = pc_row_quad(shape, 1);
    const ShapeBox box =
        pc_shape_box(pc_row_quad(shape, 0).v, pc_quaternion(facing.v, facing.s), pc_row_quad(shape, 2).v,
                     pc_row_quad(shape, 3).v, Vec3(column(BOUND_HALF), column(BOUND_HALF + 1), column(BOUND_HALF + 2)),
                     column(BOUND_ROUND), reach + column(BOUND_GROWN));
    Lanes least[3], most[3], far;
    pc_put(least, box.least);
    pc_put(most, box.most);
    pc_store(far.v, reach);
    for (uint l = 0; l < PC_LANES; l++) {
      call.reach[i + l] = float(far.v[l]);
      Aabb& to = call.boxes[i + l];
      for (uint k = 0; k < 3; k++) to.min[k] = float(least[k].v[l]), to.max[k] = float(most[k].v[l]);
    }
  }
}
#else
constexpr void (*boxes)(const BoxCall&) = nullptr;
#endif

// Of the first `count` lanes, those that are not apart; without points where they are open.
PC_INLINE uint pc_hand_out(const RoundContact& c, uint first, uint count, Manifold<Scalar>* out, uint* places) {
  const uint two = pc_mask_bits(c.two), open = pc_mask_bits(c.open),
             all = count < PC_LANES ? (1u << count) - 1u : (1u << PC_LANES) - 1u;
  uint near = all & ~pc_mask_bits(c.apart), n = 0;
  if (near == 0) return 0;
  Lanes normal[3], p[3], separation, feature, second[3], second_separation, second_feature;
  pc_put(normal, c.normal);
  pc_put(p, c.p);
  pc_store(separation.v, c.separation);
  pc_store(feature.v, c.feature);
  pc_put(second, c.second);
  pc_store(second_separation.v, c.second_separation);
  pc_store(second_feature.v, c.second_feature);
  for (; near != 0; near &= near - 1u) {
    const uint l = uint(__builtin_ctz(near));
    Manifold<Scalar>& m = out[n];
    places[n++] = first + l;
    ManifoldPoint<Scalar>* point = m.points;
    for (uint k = 0; k < 3; k++) m.normal[k] = normal[k].v[l], point->p[k] = p[k].v[l];
    point->separation = separation.v[l];
    point->feature = uint(int(feature.v[l]));
    m.count = open >> l & 1u ? 0 : 1;
    if (m.count == 0 || (two >> l & 1u) == 0) continue;
    m.count = 2;
    point++;
    for (uint k = 0; k < 3; k++) point->p[k] = second[k].v[l];
    point->separation = second_separation.v[l];
    point->feature = uint(int(second_feature.v[l]));
  }
  return n;
}

#define PC_BATCH(name, shapes, contact)                                                                             \
  static uint name(const PairBatch<Scalar>& batch, Manifold<Scalar>* out, uint* places) {                           \
    uint n = 0;                                                                                                     \
    for (uint i = 0; i < batch.count; i += PC_LANES) {                                                              \
      const Row a = pc_row(batch.rows, pc_index(batch.a + i), quads_round);                                         \
      const Row b = pc_row(batch.rows, pc_index(batch.b + i), quads_round);                                         \
      n += pc_hand_out(contact(shapes(a, b), pc_load(batch.margins + i)), i, batch.count - i, out + n, places + n); \
    }                                                                                                               \
    return n;                                                                                                       \
  }
PC_BATCH(spheres, pc_round_pair, pc_two_spheres)
PC_BATCH(capsules, pc_round_pair, pc_two_capsules)
PC_BATCH(sphere_box, pc_round_on_box, pc_sphere_on_box)
PC_BATCH(capsule_box, pc_round_on_box, pc_capsule_on_box)
#undef PC_BATCH
}  // namespace PC_NAMESPACE

const NarrowLanes<PC_SCALAR> PC_EXPORT = {
    PC_LANES,
    PC_NAMESPACE::twists,
    PC_NAMESPACE::boxes,
    {PC_NAMESPACE::spheres, PC_NAMESPACE::capsules, PC_NAMESPACE::sphere_box, PC_NAMESPACE::capsule_box}};

}  // namespace pcphys
