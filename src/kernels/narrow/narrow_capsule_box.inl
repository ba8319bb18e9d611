// A capsule and a box, in the box's axes, whichever way they meet. Notation: narrow_over_box.inl.

// A normal leaves an edge sideways where its component along it is below this.
#define PC_BESIDE_EDGE PC_REAL(0.05)

// The direction out of the box in which the axis of the capsule is at `gap` from it, and where on the axis.
struct CapsuleAxis {
  Vec3 outward;
  Real gap;
  Real t;
};
PC_FN void pc_try_capsule_edge(PC_INOUT(CapsuleAxis) best, Vec3 axis, Vec3 c, Vec3 b, Real slop) {
  Real squared = pc_dot(axis, axis);
  if (!(squared > PC_SLIGHT)) return;
  Vec3 l = pc_scale(axis, pc_div(PC_REAL(1.0), pc_sqrt(squared)));
  Real along = pc_dot(c, l);
  precise Real gap = pc_abs(along) - pc_dot(b, pc_abs3(l));
  precise Real beat = best.gap + slop;
  if (gap > beat) {
    best.gap = gap;
    best.outward = along < PC_REAL(0.0) ? pc_negate(l) : l;
  }
}
// Where the axis meets the box: the face or the edge axis (u x box axis) of least depth.
PC_FN CapsuleAxis pc_capsule_through_box(Vec3 c, Vec3 u, Real h, Vec3 b) {
  precise Vec3 gaps = pc_abs3(c) - pc_abs3(u) * h - b;
  uint i = pc_greatest_component(gaps);
  CapsuleAxis best;
  best.gap = pc_component(gaps, i);
  best.outward = pc_unit_axis(i, pc_sign(pc_component(c, i)));
  precise Real slop = pc_smallest(b) * PC_LITTLE;
  pc_try_capsule_edge(best, Vec3(PC_REAL(0.0), -u.z, u.y), c, b, slop);
  pc_try_capsule_edge(best, Vec3(u.z, PC_REAL(0.0), -u.x), c, b, slop);
  pc_try_capsule_edge(best, Vec3(-u.y, u.x, PC_REAL(0.0)), c, b, slop);
  // the deepest point: an end, or where the axis passes over an edge of the box
  Real lean = pc_dot(u, best.outward);
  if (pc_abs(lean) > PC_LITTLE) {
    best.t = lean > PC_REAL(0.0) ? -h : h;
  } else {
    uint j = pc_least_component(best.outward);
    Vec3 w = pc_edge_middle(b, j, best.outward);
    best.t = pc_closest_segments(c, u, h, w, pc_unit_axis(j, PC_REAL(1.0)), pc_component(b, j)).s;
  }
  return best;
}
PC_FN CapsuleAxis pc_capsule_axis(Vec3 c, Vec3 u, Real h, Real r, Vec3 b) {
  CapsuleAxis o;
  o.t = pc_closest_on_segment_to_box(c, u, h, b);
  Vec3 e = pc_excess(pc_madd(c, u, o.t), b);
  o.gap = pc_length(e);
  precise Real touch = (r + h) * PC_CORE_TOUCH;
  if (!(o.gap > touch)) return pc_capsule_through_box(c, u, h, b);
  o.outward = pc_scale(e, pc_div(PC_REAL(1.0), o.gap));
  return o;
}
// Beside an edge: two points where they run together.
PC_FN void pc_capsule_beside_edge(Round capsule, Vec3 c, Vec3 u, CapsuleAxis k, Axes axes, Vec3 b, Real margin,
                                  PC_INOUT(NarrowManifold) m) {
  uint i = pc_least_component(k.outward);
  Vec3 w = pc_sub(pc_edge_middle(b, i, k.outward), c);
  Real lean1 = pc_component(u, pc_next(i));
  Real lean2 = pc_component(u, pc_next(pc_next(i)));
  SegmentPair s;
  s.s = k.t;
  s.t = PC_REAL(0.0);
  precise Real lean = lean1 * lean1 + lean2 * lean2;
  s.sine_squared = lean;
  s.cosine = pc_component(u, i);
  s.along = pc_dot(u, w);
  Round edge;
  edge.p = pc_add(capsule.p, pc_to_world(axes, w));
  edge.r = PC_REAL(0.0);
  edge.u = pc_axis(axes, i);
  edge.h = pc_component(b, i);
  pc_parallel_points(capsule, edge, s, margin, 32u + i * 2u, m);
}

PC_FN_LARGE void pc_capsule_box(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Axes axes = pc_axes(b.q);
  Round capsule = pc_round_of(a);
  Vec3 hb = b.size;
  Real h = capsule.h;
  Real r = capsule.r;
  RoundContact over = pc_capsule_over_box(capsule, b.p, axes, hb, margin);
  if (over.apart || !over.open) {
    pc_push_round(over, m);
    return;
  }
  Vec3 c = pc_to_local(axes, pc_sub(a.p, b.p));
  Vec3 u = pc_to_local(axes, capsule.u);
  CapsuleAxis k = pc_capsule_axis(c, u, h, r, hb);
  precise Real separation = k.gap - r;
  if (separation > margin) return;
  m.normal = pc_negate(pc_to_world(axes, k.outward));

  OverFace o = pc_over_face(c, u, h, r, hb, k.outward, separation, margin);
  if (o.face) {
    uint tag = uint(o.tag);
    if (o.first) pc_push(m, pc_midway(pc_madd(a.p, capsule.u, o.first_t), m.normal, r, o.first_gap), o.first_gap, tag);
    if (o.second)
      pc_push(m, pc_midway(pc_madd(a.p, capsule.u, o.second_t), m.normal, r, o.second_gap), o.second_gap, tag + 1u);
  } else if (pc_smallest(pc_abs3(k.outward)) < PC_BESIDE_EDGE) {
    pc_capsule_beside_edge(capsule, c, u, k, axes, hb, margin, m);
  }
  // the closest point itself, where nothing else holds it
  precise Real deepest = separation + (r + h) * PC_HELD_SLOP;
  bool held = false;
  for (uint i = 0u; i < m.count; i++) held = held || m.points[i].separation <= deepest;
  if (!held) pc_push_from(m, pc_madd(a.p, capsule.u, k.t), m.normal, r, separation, margin, 0u);
}
