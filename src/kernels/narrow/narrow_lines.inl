// Points and segments with a radius: spheres and capsules against each other. Without branches on data, so that many
// pairs may stand side by side in lanes (collision/narrow_lanes.inl):
// lanes of which something is not true keep what they have.

// squared sine of 1.5 and 3 degrees: between them two lines pass from parallel (two points) to crossing (one)
#define PC_PARALLEL_FULL PC_REAL(0.000685237)
#define PC_PARALLEL_NONE PC_REAL(0.00273905)
#define PC_PARALLEL_RATE PC_REAL(486.895)  // 1 / (none - full)
// below this squared sine two directions have no usable cross product
#define PC_PARALLEL_EXACT PC_REAL(1e-8)
// cores closer than this times their size have no usable difference vector
#define PC_CORE_TOUCH PC_REAL(1e-4)
// a face whose normal is this near the contact normal carries the contact (0.8 degrees)
#define PC_FACE_FLAT PC_REAL(0.9999)
// the closest point is added where no other point is as deep to this times the smaller core's size
#define PC_HELD_SLOP PC_REAL(2e-5)

// Centre, radius, axis and half its length.
struct Round {
  Vec3 p;
  Real r;
  Vec3 u;
  Real h;
};
// What two of them give: where they are farther apart than the margin, nothing; else the point p, and where `two` a
// second one. (Or where it is `open`, the whole text of the pair must say.)
struct RoundContact {
  Mask apart;
  Mask open;
  Vec3 normal;
  Vec3 p;
  Real separation;
  Real feature;
  Mask two;
  Vec3 second;
  Real second_separation;
  Real second_feature;
};
struct Axes {
  Vec3 x;
  Vec3 y;
  Vec3 z;
};

PC_FN Mask pc_not(Mask m) { return pc_select(m, PC_REAL(0.0), PC_REAL(1.0)) > PC_REAL(0.5); }
PC_FN Vec3 pc_axis_x(Quaternion q) {
  precise Real x = PC_REAL(1.0) - PC_REAL(2.0) * (q.v.y * q.v.y + q.v.z * q.v.z);
  precise Real y = PC_REAL(2.0) * (q.v.x * q.v.y + q.w * q.v.z);
  precise Real z = PC_REAL(2.0) * (q.v.x * q.v.z - q.w * q.v.y);
  return Vec3(x, y, z);
}
PC_FN Vec3 pc_axis_y(Quaternion q) {
  precise Real x = PC_REAL(2.0) * (q.v.x * q.v.y - q.w * q.v.z);
  precise Real y = PC_REAL(1.0) - PC_REAL(2.0) * (q.v.x * q.v.x + q.v.z * q.v.z);
  precise Real z = PC_REAL(2.0) * (q.v.y * q.v.z + q.w * q.v.x);
  return Vec3(x, y, z);
}
PC_FN Vec3 pc_axis_z(Quaternion q) {
  precise Real x = PC_REAL(2.0) * (q.v.x * q.v.z + q.w * q.v.y);
  precise Real y = PC_REAL(2.0) * (q.v.y * q.v.z - q.w * q.v.x);
  precise Real z = PC_REAL(1.0) - PC_REAL(2.0) * (q.v.x * q.v.x + q.v.y * q.v.y);
  return Vec3(x, y, z);
}
PC_FN Axes pc_axes(Quaternion q) {
  Axes m;
  m.x = pc_axis_x(q);
  m.y = pc_axis_y(q);
  m.z = pc_axis_z(q);
  return m;
}
PC_FN Vec3 pc_to_local(Axes m, Vec3 v) { return Vec3(pc_dot(m.x, v), pc_dot(m.y, v), pc_dot(m.z, v)); }
PC_FN Vec3 pc_to_world(Axes m, Vec3 v) { return pc_combine(m.x, v.x, m.y, v.y, m.z, v.z); }
PC_FN Real pc_sign(Real x) { return pc_select(x < PC_REAL(0.0), PC_REAL(-1.0), PC_REAL(1.0)); }
PC_FN Vec3 pc_abs3(Vec3 v) { return Vec3(pc_abs(v.x), pc_abs(v.y), pc_abs(v.z)); }
PC_FN Real pc_smallest(Vec3 v) { return pc_min(v.x, pc_min(v.y, v.z)); }
PC_FN Real pc_largest(Vec3 v) { return pc_max(v.x, pc_max(v.y, v.z)); }
// A length whose square is safely a number above zero.
PC_FN Mask pc_has_length(Real squared) {
  precise Real least = PC_TINY * PC_TINY;
  return squared > least;
}
// Any unit vector perpendicular to the unit vector u, always the same one.
PC_FN Vec3 pc_perpendicular(Vec3 u) {
  Vec3 e = pc_select3(pc_abs(u.x) < PC_STEEP, Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0)),
                      Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)));
  return pc_unit_or_zero(pc_madd(e, u, -pc_dot(e, u)));
}
PC_FN RoundContact pc_no_contact(Mask apart) {
  Real zero = PC_REAL(0.0);
  RoundContact c;
  c.apart = apart;
  c.normal = pc_zero3();
  c.p = c.normal;
  c.separation = zero;
  c.feature = zero;
  c.open = zero > zero;
  c.two = c.open;
  c.second = c.normal;
  c.second_separation = zero;
  c.second_feature = PC_REAL(2.0);
  return c;
}

// Two round cores at their closest points; `other` is the normal where the points coincide.
PC_FN RoundContact pc_round_cores(Vec3 xa, Real ra, Vec3 xb, Real rb, Vec3 other, Real margin) {
  Vec3 d = pc_sub(xb, xa);
  Real squared = pc_dot(d, d);
  precise Real radii = ra + rb;
  precise Real reach = radii + margin;
  precise Real farthest = reach * reach;
  RoundContact c = pc_no_contact(squared > farthest);
  Real distance = pc_sqrt(squared);
  c.normal = pc_select3(pc_has_length(squared), pc_scale(d, pc_div(PC_REAL(1.0), pc_max(distance, PC_TINY))), other);
  precise Real separation = distance - radii;
  precise Real half_way = ra + separation * PC_REAL(0.5);
  c.separation = separation;
  c.p = pc_madd(xa, c.normal, half_way);
  return c;
}
PC_FN RoundContact pc_spheres(Round a, Round b, Real margin) {
  return pc_round_cores(a.p, a.r, b.p, b.r, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)), margin);
}

// ---- two segments ---------------------------------------------------------------------------------------
// Closest at xa + ua s, xb + ub t.
struct SegmentPair {
  Real s;
  Real t;
  Real along;
  Real cosine;
  Real sine_squared;
};
// Segments xa + ua [-ha, ha] and xb + ub [-hb, hb]. Where they are parallel the middle of the overlap is taken.
PC_FN SegmentPair pc_closest_segments(Vec3 xa, Vec3 ua, Real ha, Vec3 xb, Vec3 ub, Real hb) {
  SegmentPair o;
  Vec3 w = pc_sub(xb, xa);
  Vec3 c = pc_cross(ua, ub);
  Real b = pc_dot(ua, ub);
  Real wa = pc_dot(ua, w);
  Real wb = pc_dot(ub, w);
  o.along = wa;
  o.cosine = b;
  o.sine_squared = pc_dot(c, c);
  precise Real numerator = wa - b * wb;
  Real crossing = pc_div(numerator, pc_max(o.sine_squared, PC_PARALLEL_EXACT));
  precise Real low = wa - hb;
  precise Real high = wa + hb;
  precise Real middle = (pc_max(low, -ha) + pc_min(high, ha)) * PC_REAL(0.5);
  o.s = pc_clamp(pc_select(o.sine_squared > PC_PARALLEL_EXACT, crossing, middle), -ha, ha);
  precise Real t = b * o.s - wb;
  o.t = pc_clamp(t, -hb, hb);
  precise Real s = wa + b * o.t;
  o.s = pc_clamp(s, -ha, ha);
  return o;
}

// 1 for parallel lines, falling to 0 at three degrees.
PC_FN Real pc_parallel_share(Real sine_squared) {
  precise Real left = (PC_PARALLEL_NONE - sine_squared) * PC_PARALLEL_RATE;
  return pc_clamp(left, PC_REAL(0.0), PC_REAL(1.0));
}
// Two points over the common stretch of two nearly parallel segments; they close in on the closest point as
// the angle grows, so that nothing jumps where one point takes over.
struct Stretch {
  Mask exists;
  Vec3 first;
  Real first_separation;
  Vec3 second;
  Real second_separation;
};
struct StretchEnd {
  Vec3 p;
  Real separation;
};
PC_FN StretchEnd pc_stretch_end(Round a, Round b, SegmentPair o, Vec3 normal, Real end) {
  Real share = pc_parallel_share(o.sine_squared);
  Real inverse = pc_div(PC_REAL(1.0), o.cosine);
  precise Real radii = a.r + b.r;
  precise Real shift = (a.r - b.r) * PC_REAL(0.5);
  precise Real off = end - o.s;
  precise Real s = o.s + off * share;
  precise Real t = (s - o.along) * inverse;
  Vec3 pa = pc_madd(a.p, a.u, s);
  Vec3 pb = pc_madd(b.p, b.u, pc_clamp(t, -b.h, b.h));
  Vec3 d = pc_sub(pb, pa);
  precise Real separation = pc_dot(d, normal) - radii;
  precise Vec3 middle = pa + d * PC_REAL(0.5) + normal * shift;
  StretchEnd e;
  e.p = middle;
  e.separation = separation;
  return e;
}
PC_FN Stretch pc_stretch(Round a, Round b, SegmentPair o, Vec3 normal) {
  precise Real reach = pc_abs(o.cosine) * b.h;
  precise Real from = o.along - reach;
  precise Real to = o.along + reach;
  Real low = pc_max(from, -a.h);
  Real high = pc_min(to, a.h);
  precise Real shortest = pc_min(a.h, b.h) * PC_SOME;
  precise Real overlap = high - low;
  StretchEnd first = pc_stretch_end(a, b, o, normal, low);
  StretchEnd second = pc_stretch_end(a, b, o, normal, high);
  Stretch r;
  r.exists = pc_and(o.sine_squared<PC_PARALLEL_NONE, overlap> shortest);
  r.first = first.p;
  r.first_separation = first.separation;
  r.second = second.p;
  r.second_separation = second.separation;
  return r;
}
// In place of the closest point, those of the two that are within the margin, if any is.
PC_FN RoundContact pc_with_stretch(RoundContact c, Stretch s, Real margin) {
  RoundContact r = c;
  Mask first = pc_and(s.exists, pc_not(s.first_separation > margin));
  Mask second = pc_and(s.exists, pc_not(s.second_separation > margin));
  r.p = pc_select3(first, s.first, pc_select3(second, s.second, c.p));
  r.separation = pc_select(first, s.first_separation, pc_select(second, s.second_separation, c.separation));
  r.feature = pc_select(first, PC_REAL(1.0), pc_select(second, PC_REAL(2.0), c.feature));
  r.two = pc_and(first, second);
  r.second = s.second;
  r.second_separation = s.second_separation;
  return r;
}

// The feature is 0 of the closest point, 1 and 2 of the ends of a common stretch.
PC_FN RoundContact pc_capsules(Round a, Round b, Real margin) {
  SegmentPair o = pc_closest_segments(a.p, a.u, a.h, b.p, b.u, b.h);
  Vec3 pa = pc_madd(a.p, a.u, o.s);
  Vec3 pb = pc_madd(b.p, b.u, o.t);
  Vec3 d = pc_sub(pb, pa);
  Real squared = pc_dot(d, d);
  precise Real radii = a.r + b.r;
  precise Real reach = radii + margin;
  precise Real farthest = reach * reach;
  RoundContact c = pc_no_contact(squared > farthest);
  Mask near = pc_not(c.apart);
  if (!PC_ANY(near)) return c;  // lint: allow (nothing else is asked for)
  Real distance = pc_sqrt(squared);
  precise Real least = radii * PC_SLIGHT;
  Mask touching = pc_not(pc_and(distance > least, pc_has_length(squared)));
  c.normal = pc_scale(d, pc_div(PC_REAL(1.0), pc_max(distance, PC_TINY)));
  // where the axes cross: out along their common perpendicular
  if (PC_ANY(pc_and(near, touching))) {  // lint: allow (other lanes keep what they have)
    Vec3 out_ =
        pc_select3(o.sine_squared > PC_PARALLEL_EXACT, pc_unit_or_zero(pc_cross(a.u, b.u)), pc_perpendicular(a.u));
    out_ = pc_select3(pc_dot(out_, pc_sub(b.p, a.p)) < PC_REAL(0.0), pc_negate(out_), out_);
    c.normal = pc_select3(touching, out_, c.normal);
  }
  precise Real separation = distance - radii;
  precise Real half_way = a.r + separation * PC_REAL(0.5);
  c.separation = separation;
  c.p = pc_madd(pa, c.normal, half_way);
  if (PC_ANY(pc_and(near, o.sine_squared < PC_PARALLEL_NONE))) {  // lint: allow (as above)
    c = pc_with_stretch(c, pc_stretch(a, b, o, c.normal), margin);
  }
  return c;
}
