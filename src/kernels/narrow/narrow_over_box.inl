// A sphere or a capsule at a distance from a box: what most of such pairs are, without branches on data. Cores that
// meet the box, edges and corners beside a capsule stay open (narrow_round.inl, narrow_capsule_box.inl).
//
// A capsule in the box's axes: x(t) = c + u t, |t| <= h, against the slabs |x_i| <= b_i. Half the derivative of the
// squared distance, g(t) = sum_i u_i (x_i(t) - clamp(x_i(t))), never falls and is linear between the slab crossings, so
// its root is found exactly by trying the six crossings.

PC_FN Vec3 pc_excess(Vec3 x, Vec3 b) {
  Vec3 inside = Vec3(pc_clamp(x.x, -b.x, b.x), pc_clamp(x.y, -b.y, b.y), pc_clamp(x.z, -b.z, b.z));
  return pc_sub(x, inside);
}
struct Bracket {
  Real low;
  Real high;
  Real g_low;
  Real g_high;
};
PC_FN Bracket pc_narrow_bracket(Bracket k, Vec3 c, Vec3 u, Vec3 b, Real crossing, Real slope) {
  Real t = pc_div(crossing, pc_select(slope < PC_REAL(0.0), slope, pc_max(slope, PC_LEAST)));
  Mask within = pc_and(pc_and(t > k.low, t < k.high), pc_not(pc_abs(slope) < PC_LEAST));
  Real g = pc_dot(u, pc_excess(pc_madd(c, u, t), b));
  Mask falls = pc_and(within, g < PC_REAL(0.0));
  Mask rises = pc_and(within, pc_not(g < PC_REAL(0.0)));
  Bracket r;
  r.low = pc_select(falls, t, k.low);
  r.g_low = pc_select(falls, g, k.g_low);
  r.high = pc_select(rises, t, k.high);
  r.g_high = pc_select(rises, g, k.g_high);
  return r;
}
PC_FN Real pc_closest_on_segment_to_box(Vec3 c, Vec3 u, Real h, Vec3 b) {
  Bracket k;
  k.low = -h;
  k.high = h;
  Real zero = PC_REAL(0.0);
  k.g_low = pc_dot(u, pc_excess(pc_madd(c, u, -h), b));
  k.g_high = pc_dot(u, pc_excess(pc_madd(c, u, h), b));
  Mask at_low = pc_not(k.g_low < zero);
  Mask at_high = pc_not(k.g_high > zero);
  Real end = pc_select(at_low, -h, h);
  Mask ends = pc_or(at_low, at_high);
  if (!PC_ANY(pc_not(ends))) return end;  // lint: allow (what is selected below)
  precise Vec3 enter = pc_negate(c) - b;
  precise Vec3 leave = b - c;
  k = pc_narrow_bracket(k, c, u, b, enter.x, u.x);
  k = pc_narrow_bracket(k, c, u, b, leave.x, u.x);
  k = pc_narrow_bracket(k, c, u, b, enter.y, u.y);
  k = pc_narrow_bracket(k, c, u, b, leave.y, u.y);
  k = pc_narrow_bracket(k, c, u, b, enter.z, u.z);
  k = pc_narrow_bracket(k, c, u, b, leave.z, u.z);
  precise Real rise = k.g_high - k.g_low;
  precise Real t = k.low - (k.high - k.low) * pc_div(k.g_low, pc_select(rise > zero, rise, PC_REAL(1.0)));
  return pc_select(ends, end, pc_select(rise > zero, pc_clamp(t, k.low, k.high), k.low));
}

#define PC_OVER_FACE_TAG PC_REAL(16.0)
#define PC_TAG_Y PC_REAL(4.0)
#define PC_TAG_Z PC_REAL(8.0)
// Above a face, whose outward direction `out_` is: both ends of what of the axis lies over it.
// Directions in the box's axes.
struct OverFace {
  Mask face;
  Mask first;
  Mask second;
  Mask held;
  Real first_t;
  Real second_t;
  Real first_gap;
  Real second_gap;
  Real tag;
};
struct Span {
  Real low;
  Real high;
};
PC_FN Span pc_over_slab(Span s, Real c, Real u, Real b) {
  Mask leans = pc_abs(u) > PC_SLIGHT;
  Real slope = pc_select(leans, u, PC_REAL(1.0));
  precise Real under = -b - c;
  precise Real over = b - c;
  Real t0 = pc_div(under, slope);
  Real t1 = pc_div(over, slope);
  Span r;
  r.low = pc_select(leans, pc_max(s.low, pc_min(t0, t1)), s.low);
  r.high = pc_select(leans, pc_min(s.high, pc_max(t0, t1)), s.high);
  return r;
}
// `separation`: of the closest point.
PC_FN OverFace pc_over_face(Vec3 c, Vec3 u, Real h, Real r, Vec3 hb, Vec3 out_, Real separation, Real margin) {
  Vec3 steep = pc_abs3(out_);
  Mask y = steep.y > steep.x;
  Mask z = steep.z > pc_select(y, steep.y, steep.x);
  // of the face's own axis and the two after it
  Vec3 hb_f = pc_select3(z, Vec3(hb.z, hb.x, hb.y), pc_select3(y, Vec3(hb.y, hb.z, hb.x), hb));
  Vec3 c_f = pc_select3(z, Vec3(c.z, c.x, c.y), pc_select3(y, Vec3(c.y, c.z, c.x), c));
  Vec3 u_f = pc_select3(z, Vec3(u.z, u.x, u.y), pc_select3(y, Vec3(u.y, u.z, u.x), u));
  Real top = pc_largest(steep);
  Real zero = PC_REAL(0.0);
  Real side = pc_sign(pc_select(z, out_.z, pc_select(y, out_.y, out_.x)));
  Span s;
  s.low = -h;
  s.high = h;
  s = pc_over_slab(s, c_f.y, u_f.y, hb_f.y);
  s = pc_over_slab(s, c_f.z, u_f.z, hb_f.z);
  OverFace o;
  o.face = top > PC_FACE_FLAT;
  Mask some = pc_and(o.face, s.high > s.low);
  o.first_t = s.low;
  o.second_t = s.high;
  precise Real height0 = c_f.x + u_f.x * s.low;
  precise Real above0 = height0 * side - hb_f.x;
  precise Real gap0 = pc_div(above0, top) - r;
  precise Real height1 = c_f.x + u_f.x * s.high;
  precise Real above1 = height1 * side - hb_f.x;
  precise Real gap1 = pc_div(above1, top) - r;
  o.first_gap = gap0;
  o.second_gap = gap1;
  o.first = pc_and(some, pc_not(gap0 > margin));
  o.second = pc_and(some, pc_not(gap1 > margin));
  precise Real deepest = separation + (r + h) * PC_HELD_SLOP;
  o.held = pc_or(pc_and(o.first, pc_not(gap0 > deepest)), pc_and(o.second, pc_not(gap1 > deepest)));
  precise Real tag = PC_OVER_FACE_TAG + pc_select(z, PC_TAG_Z, pc_select(y, PC_TAG_Y, zero)) +
                     pc_select(side > zero, PC_REAL(2.0), zero);
  o.tag = tag;
  return o;
}
// The point x of a core, whose surface lies `radius` along n and the box's `separation` beyond.
PC_FN Vec3 pc_midway(Vec3 x, Vec3 n, Real radius, Real separation) {
  precise Real reach = radius + separation * PC_REAL(0.5);
  return pc_madd(x, n, reach);
}

// `b`: centre; `size`: half extents.
PC_FN RoundContact pc_capsule_over_box(Round a, Vec3 b, Axes axes, Vec3 size, Real margin) {
  Vec3 c = pc_to_local(axes, pc_sub(a.p, b));
  Vec3 u = pc_to_local(axes, a.u);
  Real r = a.r;
  Real h = a.h;
  precise Real reach = r + margin;
  precise Vec3 outside = pc_abs3(c) - pc_abs3(u) * h - size;
  RoundContact k = pc_no_contact(pc_largest(outside) > reach);
  Mask near = pc_not(k.apart);
  if (!PC_ANY(near)) return k;  // lint: allow (nothing else is asked for)
  Real t = pc_closest_on_segment_to_box(c, u, h, size);
  Vec3 e = pc_excess(pc_madd(c, u, t), size);
  Real distance = pc_length(e);
  precise Real touch = (r + h) * PC_CORE_TOUCH;
  Mask beside = distance > touch;
  Vec3 out_ = pc_scale(e, pc_div(PC_REAL(1.0), pc_max(distance, PC_TINY)));
  precise Real separation = distance - r;
  k.apart = pc_or(k.apart, pc_and(beside, separation > margin));
  k.normal = pc_negate(pc_to_world(axes, out_));
  OverFace o = pc_over_face(c, u, h, r, size, out_, separation, margin);
  k.open = pc_not(pc_and(beside, o.held));
  Vec3 p0 = pc_midway(pc_madd(a.p, a.u, o.first_t), k.normal, r, o.first_gap);
  Vec3 p1 = pc_midway(pc_madd(a.p, a.u, o.second_t), k.normal, r, o.second_gap);
  precise Real next = o.tag + PC_REAL(1.0);
  k.p = pc_select3(o.first, p0, p1);
  k.separation = pc_select(o.first, o.first_gap, o.second_gap);
  k.feature = pc_select(o.first, o.tag, next);
  k.two = pc_and(o.first, o.second);
  k.second = p1;
  k.second_separation = o.second_gap;
  k.second_feature = next;
  return k;
}
PC_FN RoundContact pc_sphere_over_box(Vec3 a, Real r, Vec3 b, Axes axes, Vec3 h, Real margin) {
  Vec3 e = pc_excess(pc_to_local(axes, pc_sub(a, b)), h);
  Real squared = pc_dot(e, e);
  precise Real reach = r + margin;
  precise Real farthest = reach * reach;
  RoundContact k = pc_no_contact(squared > farthest);
  Real distance = pc_sqrt(squared);
  k.normal = pc_negate(pc_to_world(axes, pc_scale(e, pc_div(PC_REAL(1.0), pc_max(distance, PC_TINY)))));
  precise Real separation = distance - r;
  k.separation = separation;
  k.p = pc_midway(a, k.normal, r, separation);
  k.open = pc_not(pc_has_length(squared));
  k.apart = pc_or(k.apart, pc_and(pc_has_length(squared), separation > margin));
  return k;
}
