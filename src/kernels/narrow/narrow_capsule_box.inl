// A capsule and a box, in the box's axes: x(t) = c + u t, |t| <= h, against the slabs |x_i| <= b_i.
//
// Half the derivative of the squared distance, g(t) = sum_i u_i (x_i(t) - clamp(x_i(t))), never falls and is
// linear between the slab crossings, so its root is found exactly by trying the six crossings.

PC_FN Vec3 pc_excess(Vec3 x, Vec3 b) {
  Vec3 inside = Vec3(pc_clamp(x.x, -b.x, b.x), pc_clamp(x.y, -b.y, b.y), pc_clamp(x.z, -b.z, b.z));
  return pc_sub(x, inside);
}
struct Bracket { Real low; Real high; Real g_low; Real g_high; };
PC_FN void pc_narrow_bracket(PC_INOUT(Bracket) k, Vec3 c, Vec3 u, Vec3 b, Real crossing, Real slope) {
  if (slope == PC_REAL(0.0)) return;
  Real t = pc_div(crossing, slope);
  if (!(t > k.low && t < k.high)) return;
  Real g = pc_dot(u, pc_excess(pc_madd(c, u, t), b));
  if (g < PC_REAL(0.0)) { k.low = t; k.g_low = g; } else { k.high = t; k.g_high = g; }
}
PC_FN Real pc_closest_on_segment_to_box(Vec3 c, Vec3 u, Real h, Vec3 b) {
  Bracket k; k.low = -h; k.high = h;
  k.g_low = pc_dot(u, pc_excess(pc_madd(c, u, -h), b)); k.g_high = pc_dot(u, pc_excess(pc_madd(c, u, h), b));
  if (k.g_low >= PC_REAL(0.0)) return -h;
  if (k.g_high <= PC_REAL(0.0)) return h;
  precise Vec3 enter = pc_negate(c) - b; precise Vec3 leave = b - c;
  pc_narrow_bracket(k, c, u, b, enter.x, u.x); pc_narrow_bracket(k, c, u, b, leave.x, u.x);
  pc_narrow_bracket(k, c, u, b, enter.y, u.y); pc_narrow_bracket(k, c, u, b, leave.y, u.y);
  pc_narrow_bracket(k, c, u, b, enter.z, u.z); pc_narrow_bracket(k, c, u, b, leave.z, u.z);
  precise Real rise = k.g_high - k.g_low;
  if (!(rise > PC_REAL(0.0))) return k.low;
  precise Real t = k.low - (k.high - k.low) * pc_div(k.g_low, rise);
  return pc_clamp(t, k.low, k.high);
}

// Where the axis meets the box: the face or the edge axis (u x box axis) of least depth.
struct CapsuleAxis { Vec3 outward; Real gap; };
PC_FN void pc_try_capsule_edge(PC_INOUT(CapsuleAxis) best, Vec3 axis, Vec3 c, Vec3 b, Real slop) {
  Real squared = pc_dot(axis, axis);
  if (!(squared > PC_REAL(1e-6))) return;
  Vec3 l = pc_scale(axis, pc_div(PC_REAL(1.0), pc_sqrt(squared)));
  Real along = pc_dot(c, l);
  precise Real gap = pc_abs(along) - pc_dot(b, pc_abs3(l)); precise Real beat = best.gap + slop;
  if (gap > beat) { best.gap = gap; best.outward = along < PC_REAL(0.0) ? pc_negate(l) : l; }
}
PC_FN CapsuleAxis pc_capsule_through_box(Vec3 c, Vec3 u, Real h, Vec3 b) {
  precise Vec3 gaps = pc_abs3(c) - pc_abs3(u) * h - b;
  uint i = pc_greatest_component(gaps);
  CapsuleAxis best; best.gap = pc_component(gaps, i); best.outward = pc_unit_axis(i, pc_sign(pc_component(c, i)));
  precise Real slop = pc_smallest(b) * PC_REAL(1e-4);
  pc_try_capsule_edge(best, Vec3(PC_REAL(0.0), -u.z, u.y), c, b, slop);
  pc_try_capsule_edge(best, Vec3(u.z, PC_REAL(0.0), -u.x), c, b, slop);
  pc_try_capsule_edge(best, Vec3(-u.y, u.x, PC_REAL(0.0)), c, b, slop);
  return best;
}

PC_FN_LARGE void pc_capsule_box(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Axes axes = pc_axes(b.q); Vec3 along = pc_axis_y(a.q); Vec3 hb = b.size; Real h = a.size.y; Real r = a.size.x;
  Vec3 c = pc_to_local(axes, pc_sub(a.p, b.p)); Vec3 u = pc_to_local(axes, along);
  precise Real reach = r + margin;
  precise Vec3 apart = pc_abs3(c) - pc_abs3(u) * h - hb;
  if (pc_largest(apart) > reach) return;

  // normal, in the box's axes and away from it, and the separation
  Real t = pc_closest_on_segment_to_box(c, u, h, hb);
  Vec3 x = pc_madd(c, u, t); Vec3 e = pc_excess(x, hb);
  Real distance = pc_length(e); precise Real touch = (r + h) * PC_CORE_TOUCH;
  Vec3 out_ = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0));
  if (distance > touch) {
    out_ = pc_scale(e, pc_div(PC_REAL(1.0), distance));
  } else {
    CapsuleAxis best = pc_capsule_through_box(c, u, h, hb);
    out_ = best.outward; distance = best.gap;
    // the deepest point: an end, or where the axis passes over an edge of the box
    Real lean = pc_dot(u, out_);
    if (pc_abs(lean) > PC_REAL(1e-4)) {
      t = lean > PC_REAL(0.0) ? -h : h;
    } else {
      uint i = pc_least_component(out_);
      t = pc_closest_segments(c, u, h, pc_edge_middle(hb, i, out_), pc_unit_axis(i, PC_REAL(1.0)), pc_component(hb, i)).s;
    }
  }
  precise Real separation = distance - r;
  if (separation > margin) return;
  m.normal = pc_negate(pc_to_world(axes, out_));

  Vec3 steep = pc_abs3(out_); uint f = pc_greatest_component(steep);
  uint f1 = pc_next(f); uint f2 = pc_next(f1);
  if (pc_component(steep, f) > PC_REAL(0.9999)) {
    // above a face: both ends of what lies over it
    Real low = -h; Real high = h;
    for (uint k = 0u; k < 2u; k++) {
      uint i = k == 0u ? f1 : f2; Real ui = pc_component(u, i); Real ci = pc_component(c, i); Real bi = pc_component(hb, i);
      if (pc_abs(ui) > PC_REAL(1e-6)) {
        precise Real under = -bi - ci; precise Real over = bi - ci;
        Real t0 = pc_div(under, ui); Real t1 = pc_div(over, ui);
        low = pc_max(low, pc_min(t0, t1)); high = pc_min(high, pc_max(t0, t1));
      }
    }
    Real side = pc_sign(pc_component(out_, f)); uint tag = 16u + f * 4u + (side > PC_REAL(0.0) ? 2u : 0u);
    if (high > low) {
      for (uint k = 0u; k < 2u; k++) {
        Real tk = k == 0u ? low : high;
        precise Real height = pc_component(c, f) + pc_component(u, f) * tk;
        precise Real above = height * side - pc_component(hb, f); precise Real gap = pc_div(above, pc_component(steep, f)) - r;
        pc_push_from(m, pc_madd(a.p, along, tk), m.normal, r, gap, margin, tag + k);
      }
    }
  } else if (pc_smallest(steep) < PC_REAL(0.05)) {
    // beside an edge: two points where they run together
    uint i = pc_least_component(out_); Vec3 w = pc_edge_middle(hb, i, out_);
    Vec3 centre = pc_add(a.p, pc_to_world(axes, pc_sub(w, c)));
    Real lean1 = pc_component(u, pc_next(i)); Real lean2 = pc_component(u, pc_next(pc_next(i)));
    SegmentPair o; o.s = t; o.t = PC_REAL(0.0);
    precise Real lean = lean1 * lean1 + lean2 * lean2; o.sine_squared = lean; o.cosine = pc_component(u, i); o.along = pc_dot(u, pc_sub(w, c));
    Round capsule; capsule.p = a.p; capsule.r = r; capsule.u = along; capsule.h = h;
    Round edge; edge.p = centre; edge.r = PC_REAL(0.0); edge.u = pc_axis(axes, i); edge.h = pc_component(hb, i);
    pc_parallel_points(capsule, edge, o, margin, 32u + i * 2u, m);
  }
  // the closest point itself, where nothing else holds it
  precise Real deepest = separation + (r + h) * PC_HELD_SLOP;
  bool held = false;
  for (uint k = 0u; k < m.count; k++) held = held || m.points[k].separation <= deepest;
  if (!held) pc_push_from(m, pc_madd(a.p, along, t), m.normal, r, separation, margin, 0u);
}
