// A capsule and a box, in the box's axes, whichever way they meet. Notation: narrow_over_box.inl.

// A normal leaves an edge sideways where its component along it is below this.
#define PC_BESIDE_EDGE PC_REAL(0.05)

// Where the axis meets the box: the face or the edge axis (u x box axis) of least depth.
struct CapsuleAxis {
  Vec3 outward;
  Real gap;
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
  return best;
}

PC_FN_LARGE void pc_capsule_box(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Axes axes = pc_axes(b.q);
  Round capsule = pc_round_of(a);
  Vec3 along = capsule.u;
  Vec3 hb = b.size;
  Real h = a.size.y;
  Real r = a.size.x;
  RoundContact k = pc_capsule_over_box(capsule, b.p, axes, hb, margin);
  if (k.apart || !k.open) {
    pc_push_round(k, m);
    return;
  }
  Vec3 c = pc_to_local(axes, pc_sub(a.p, b.p));
  Vec3 u = pc_to_local(axes, along);

  // normal, in the box's axes and away from it, and the separation
  Real t = pc_closest_on_segment_to_box(c, u, h, hb);
  Vec3 x = pc_madd(c, u, t);
  Vec3 e = pc_excess(x, hb);
  Real distance = pc_length(e);
  precise Real touch = (r + h) * PC_CORE_TOUCH;
  Vec3 out_ = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0));
  if (distance > touch) {
    out_ = pc_scale(e, pc_div(PC_REAL(1.0), distance));
  } else {
    CapsuleAxis best = pc_capsule_through_box(c, u, h, hb);
    out_ = best.outward;
    distance = best.gap;
    // the deepest point: an end, or where the axis passes over an edge of the box
    Real lean = pc_dot(u, out_);
    if (pc_abs(lean) > PC_LITTLE) {
      t = lean > PC_REAL(0.0) ? -h : h;
    } else {
      uint i = pc_least_component(out_);
      t = pc_closest_segments(c, u, h, pc_edge_middle(hb, i, out_), pc_unit_axis(i, PC_REAL(1.0)), pc_component(hb, i))
              .s;
    }
  }
  precise Real separation = distance - r;
  if (separation > margin) return;
  m.normal = pc_negate(pc_to_world(axes, out_));

  OverFace o = pc_over_face(c, u, h, r, hb, out_, separation, margin);
  if (o.face) {
    uint tag = uint(o.tag);
    if (o.first) pc_push(m, pc_midway(pc_madd(a.p, along, o.first_t), m.normal, r, o.first_gap), o.first_gap, tag);
    if (o.second)
      pc_push(m, pc_midway(pc_madd(a.p, along, o.second_t), m.normal, r, o.second_gap), o.second_gap, tag + 1u);
  } else if (pc_smallest(pc_abs3(out_)) < PC_BESIDE_EDGE) {
    // beside an edge: two points where they run together
    uint i = pc_least_component(out_);
    Vec3 w = pc_edge_middle(hb, i, out_);
    Vec3 centre = pc_add(a.p, pc_to_world(axes, pc_sub(w, c)));
    Real lean1 = pc_component(u, pc_next(i));
    Real lean2 = pc_component(u, pc_next(pc_next(i)));
    SegmentPair s;
    s.s = t;
    s.t = PC_REAL(0.0);
    precise Real lean = lean1 * lean1 + lean2 * lean2;
    s.sine_squared = lean;
    s.cosine = pc_component(u, i);
    s.along = pc_dot(u, pc_sub(w, c));
    Round edge;
    edge.p = centre;
    edge.r = PC_REAL(0.0);
    edge.u = pc_axis(axes, i);
    edge.h = pc_component(hb, i);
    pc_parallel_points(capsule, edge, s, margin, 32u + i * 2u, m);
  }
  // the closest point itself, where nothing else holds it
  precise Real deepest = separation + (r + h) * PC_HELD_SLOP;
  bool held = false;
  for (uint k = 0u; k < m.count; k++) held = held || m.points[k].separation <= deepest;
  if (!held) pc_push_from(m, pc_madd(a.p, along, t), m.normal, r, separation, margin, 0u);
}
