// Pairs of points and segments with a radius, and everything closed-form against a plane.

// Two round cores at their closest points; `other` is the normal where the points coincide.
PC_FN void pc_round_cores(Vec3 xa, Real ra, Vec3 xb, Real rb, Vec3 other, Real margin, uint feature, PC_INOUT(NarrowManifold) m) {
  Vec3 d = pc_sub(xb, xa); Real squared = pc_dot(d, d);
  precise Real radii = ra + rb; precise Real reach = radii + margin; precise Real farthest = reach * reach;
  if (squared > farthest) return;
  Real distance = pc_sqrt(squared);
  m.normal = pc_has_length(squared) ? pc_scale(d, pc_div(PC_REAL(1.0), distance)) : other;
  precise Real separation = distance - radii;
  precise Real half_way = ra + separation * PC_REAL(0.5);
  pc_push(m, pc_madd(xa, m.normal, half_way), separation, feature);
}

PC_FN void pc_sphere_sphere(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  pc_round_cores(a.p, a.size.x, b.p, b.size.x, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)), margin, 0u, m);
}

PC_FN void pc_sphere_capsule(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 u = pc_axis_y(b.q);
  Real t = pc_clamp(pc_dot(u, pc_sub(a.p, b.p)), -b.size.y, b.size.y);
  Vec3 x = pc_madd(b.p, u, t);
  Vec3 d = pc_sub(x, a.p);
  Vec3 other = Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  if (!pc_has_length(pc_dot(d, d))) other = pc_perpendicular(u);
  pc_round_cores(a.p, a.size.x, x, b.size.x, other, margin, 0u, m);
}

PC_FN void pc_sphere_box(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Axes axes = pc_axes(b.q); Vec3 h = b.size;
  Vec3 c = pc_to_local(axes, pc_sub(a.p, b.p));
  Vec3 inside = Vec3(pc_clamp(c.x, -h.x, h.x), pc_clamp(c.y, -h.y, h.y), pc_clamp(c.z, -h.z, h.z));
  Vec3 e = pc_sub(c, inside); Real squared = pc_dot(e, e);
  precise Real reach = a.size.x + margin; precise Real farthest = reach * reach;
  if (squared > farthest) return;
  Vec3 outward; Real distance = pc_sqrt(squared);
  if (pc_has_length(squared)) {
    outward = pc_scale(e, pc_div(PC_REAL(1.0), distance));
  } else {  // the centre is inside: out through the nearest face
    precise Vec3 room = h - pc_abs3(c);
    uint i = pc_least_component(room);
    outward = pc_unit_axis(i, pc_sign(pc_component(c, i)));
    distance = -pc_component(room, i);
  }
  m.normal = pc_negate(pc_to_world(axes, outward));
  precise Real separation = distance - a.size.x;
  pc_push_from(m, a.p, m.normal, a.size.x, separation, margin, 0u);
}

PC_FN void pc_sphere_cylinder(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Axes axes = pc_axes(b.q);
  Vec3 c = pc_to_local(axes, pc_sub(a.p, b.p));
  precise Real around = c.x * c.x + c.z * c.z; Real rho = pc_sqrt(around);
  Vec3 radial = Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0));
  if (pc_has_length(around)) { Real i = pc_div(PC_REAL(1.0), rho); precise Real x = c.x * i; precise Real z = c.z * i; radial = Vec3(x, PC_REAL(0.0), z); }
  precise Real beside = rho - b.size.x; precise Real above = pc_abs(c.y) - b.size.y;
  Real er = pc_max(beside, PC_REAL(0.0)); Real ey = pc_max(above, PC_REAL(0.0));
  precise Real squared = er * er + ey * ey;
  Real distance = pc_sqrt(squared); Vec3 outward;
  if (pc_has_length(squared)) {
    Real i = pc_div(PC_REAL(1.0), distance); precise Real r = er * i; precise Real y = ey * i * pc_sign(c.y);
    precise Real x = radial.x * r; precise Real z = radial.z * r;
    outward = Vec3(x, y, z);
  } else {
    distance = pc_max(beside, above);
    outward = above >= beside ? Vec3(PC_REAL(0.0), pc_sign(c.y), PC_REAL(0.0)) : radial;
  }
  m.normal = pc_negate(pc_to_world(axes, outward));
  precise Real separation = distance - a.size.x;
  pc_push_from(m, a.p, m.normal, a.size.x, separation, margin, 0u);
}

// ---- two segments ---------------------------------------------------------------------------------------
struct SegmentPair { Real s; Real t; Real along; Real cosine; Real sine_squared; };  // closest at xa + ua s, xb + ub t
// Segments xa + ua [-ha, ha] and xb + ub [-hb, hb]. Where they are parallel the middle of the overlap is taken.
PC_FN SegmentPair pc_closest_segments(Vec3 xa, Vec3 ua, Real ha, Vec3 xb, Vec3 ub, Real hb) {
  SegmentPair o;
  Vec3 w = pc_sub(xb, xa); Vec3 c = pc_cross(ua, ub);
  Real b = pc_dot(ua, ub); Real wa = pc_dot(ua, w); Real wb = pc_dot(ub, w);
  o.along = wa; o.cosine = b; o.sine_squared = pc_dot(c, c);
  if (o.sine_squared > PC_PARALLEL_EXACT) {
    precise Real numerator = wa - b * wb;
    o.s = pc_clamp(pc_div(numerator, o.sine_squared), -ha, ha);
  } else {
    precise Real low = wa - hb; precise Real high = wa + hb;
    precise Real middle = (pc_max(low, -ha) + pc_min(high, ha)) * PC_REAL(0.5);
    o.s = pc_clamp(middle, -ha, ha);
  }
  precise Real t = b * o.s - wb; o.t = pc_clamp(t, -hb, hb);
  precise Real s = wa + b * o.t; o.s = pc_clamp(s, -ha, ha);
  return o;
}

// 1 for parallel lines, falling to 0 at three degrees.
PC_FN Real pc_parallel_share(Real sine_squared) {
  precise Real left = (PC_PARALLEL_NONE - sine_squared) * PC_REAL(486.895);  // 1 / (none - full)
  return pc_clamp(left, PC_REAL(0.0), PC_REAL(1.0));
}

// Two points over the common stretch of two nearly parallel segments; they close in on the closest point as
// the angle grows, so that nothing jumps where one point takes over. Returns whether it did.
PC_FN bool pc_parallel_points(Vec3 xa, Vec3 ua, Real ha, Real ra, Vec3 xb, Vec3 ub, Real hb, Real rb, SegmentPair o, Real margin, uint feature, PC_INOUT(NarrowManifold) m) {
  if (o.sine_squared >= PC_PARALLEL_NONE) return false;
  precise Real reach = pc_abs(o.cosine) * hb; precise Real from = o.along - reach; precise Real to = o.along + reach;
  Real low = pc_max(from, -ha); Real high = pc_min(to, ha);
  precise Real shortest = pc_min(ha, hb) * PC_REAL(0.01); precise Real overlap = high - low;
  if (!(overlap > shortest)) return false;
  Real share = pc_parallel_share(o.sine_squared); Real inverse = pc_div(PC_REAL(1.0), o.cosine);
  precise Real radii = ra + rb; precise Real shift = (ra - rb) * PC_REAL(0.5);
  for (uint k = 0u; k < 2u; k++) {
    precise Real off = (k == 0u ? low : high) - o.s; precise Real s = o.s + off * share;
    precise Real t = (s - o.along) * inverse;
    Vec3 pa = pc_madd(xa, ua, s); Vec3 pb = pc_madd(xb, ub, pc_clamp(t, -hb, hb));
    Vec3 d = pc_sub(pb, pa);
    precise Real separation = pc_dot(d, m.normal) - radii;
    precise Vec3 middle = pa + d * PC_REAL(0.5) + m.normal * shift;
    if (separation <= margin) pc_push(m, middle, separation, feature + k);
  }
  return m.count > 0u;
}

PC_FN void pc_capsule_capsule(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 ua = pc_axis_y(a.q); Vec3 ub = pc_axis_y(b.q);
  Real ha = a.size.y; Real hb = b.size.y; Real ra = a.size.x; Real rb = b.size.x;
  SegmentPair o = pc_closest_segments(a.p, ua, ha, b.p, ub, hb);
  Vec3 pa = pc_madd(a.p, ua, o.s); Vec3 pb = pc_madd(b.p, ub, o.t);
  Vec3 d = pc_sub(pb, pa); Real squared = pc_dot(d, d);
  precise Real radii = ra + rb; precise Real reach = radii + margin; precise Real farthest = reach * reach;
  if (squared > farthest) return;
  Real distance = pc_sqrt(squared);
  precise Real least = radii * PC_REAL(1e-6);
  if (distance > least && pc_has_length(squared)) {
    m.normal = pc_scale(d, pc_div(PC_REAL(1.0), distance));
  } else {  // the axes cross: out along their common perpendicular
    m.normal = o.sine_squared > PC_PARALLEL_EXACT ? pc_unit_or_zero(pc_cross(ua, ub)) : pc_perpendicular(ua);
    if (pc_dot(m.normal, pc_sub(b.p, a.p)) < PC_REAL(0.0)) m.normal = pc_negate(m.normal);
  }
  if (pc_parallel_points(a.p, ua, ha, ra, b.p, ub, hb, rb, o, margin, 1u, m)) return;
  precise Real separation = distance - radii; precise Real half_way = ra + separation * PC_REAL(0.5);
  pc_push(m, pc_madd(pa, m.normal, half_way), separation, 0u);
}

// ---- against a plane ------------------------------------------------------------------------------------
PC_FN void pc_sphere_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q);
  precise Real separation = pc_dot(up, pc_sub(a.p, b.p)) - a.size.x;
  m.normal = pc_negate(up);
  pc_push_from(m, a.p, m.normal, a.size.x, separation, margin, 0u);
}

PC_FN void pc_capsule_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q); Vec3 u = pc_axis_y(a.q); Real r = a.size.x;
  Real height = pc_dot(up, pc_sub(a.p, b.p)); Real slope = pc_dot(up, u);
  m.normal = pc_negate(up);
  for (uint k = 0u; k < 2u; k++) {
    Real t = k == 0u ? -a.size.y : a.size.y;
    precise Real separation = height + slope * t - r;
    pc_push_from(m, pc_madd(a.p, u, t), m.normal, r, separation, margin, k);
  }
}

// The corners of the face that looks most towards the plane; feature = number of the corner.
PC_FN void pc_box_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q); Axes axes = pc_axes(a.q); Vec3 h = a.size;
  Vec3 l = pc_to_local(axes, up); Real height = pc_dot(up, pc_sub(a.p, b.p));
  m.normal = pc_negate(up);
  uint i = pc_greatest_component(pc_abs3(l));
  bool low = pc_component(l, i) > PC_REAL(0.0);
  for (uint k = 0u; k < 8u; k++) {
    if ((((k >> i) & 1u) == 0u) == low) {
      Vec3 v = Vec3((k & 1u) == 0u ? -h.x : h.x, (k & 2u) == 0u ? -h.y : h.y, (k & 4u) == 0u ? -h.z : h.z);
      precise Real separation = height + pc_dot(l, v);
      pc_push_from(m, pc_add(a.p, pc_to_world(axes, v)), m.normal, PC_REAL(0.0), separation, margin, k);
    }
  }
}

// Rim points at four fixed angles, or the exact lowest points where the cylinder leans: the lowest of both
// rims, and the two a quarter turn beside it.
PC_FN void pc_cylinder_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q); Axes axes = pc_axes(a.q); Real r = a.size.x; Real h = a.size.y;
  Vec3 l = pc_to_local(axes, up); Real height = pc_dot(up, pc_sub(a.p, b.p));
  m.normal = pc_negate(up);
  precise Real lean_squared = l.x * l.x + l.z * l.z;
  Real bottom = l.y > PC_REAL(0.0) ? -h : h;
  bool leans = lean_squared > PC_REAL(1e-7);  // 0.02 degrees: below, fixed points are right to 1e-4 of the radius
  Real ux = PC_REAL(1.0); Real uz = PC_REAL(0.0);
  if (leans) { Real i = pc_div(PC_REAL(-1.0), pc_sqrt(lean_squared)); precise Real x = l.x * i; precise Real z = l.z * i; ux = x; uz = z; }
  uint base = leans ? 8u : 0u;
  for (uint k = 0u; k < 4u; k++) {
    // k = 0 lowest, 1 and 2 beside, 3 opposite; a leaning cylinder's other rim is nearer than its opposite side when it lies
    Real cx = k == 0u ? ux : (k == 1u ? -uz : (k == 2u ? uz : -ux)); Real cz = k == 0u ? uz : (k == 1u ? ux : (k == 2u ? -ux : -uz));
    Real y = bottom;
    if (k == 3u && pc_abs(l.y) < PC_REAL(0.70710678)) { cx = ux; cz = uz; y = -bottom; }
    precise Real vx = cx * r; precise Real vz = cz * r; Vec3 v = Vec3(vx, y, vz);
    precise Real separation = height + pc_dot(l, v);
    pc_push_from(m, pc_add(a.p, pc_to_world(axes, v)), m.normal, PC_REAL(0.0), separation, margin, base + k);
  }
}
