// Pairs of points and segments with a radius, and everything closed-form against a plane.

PC_FN Round pc_round_of(NarrowShape s) {
  Round r;
  r.p = s.p;
  r.r = s.size.x;
  r.u = pc_axis_y(s.q);
  r.h = s.size.y;
  return r;
}
PC_FN void pc_push_round(RoundContact c, PC_INOUT(NarrowManifold) m) {
  if (c.apart) return;
  m.normal = c.normal;
  pc_push(m, c.p, c.separation, uint(c.feature));
  if (c.two) pc_push(m, c.second, c.second_separation, uint(c.second_feature));
}
PC_FN void pc_sphere_sphere(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  pc_push_round(pc_round_cores(a.p, a.size.x, b.p, b.size.x, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)), margin),
                m);
}
PC_FN void pc_capsule_capsule(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  pc_push_round(pc_capsules(pc_round_of(a), pc_round_of(b), margin), m);
}

PC_FN void pc_sphere_capsule(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 u = pc_axis_y(b.q);
  Real t = pc_clamp(pc_dot(u, pc_sub(a.p, b.p)), -b.size.y, b.size.y);
  Vec3 x = pc_madd(b.p, u, t);
  Vec3 d = pc_sub(x, a.p);
  Vec3 other = Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  if (!pc_has_length(pc_dot(d, d))) other = pc_perpendicular(u);
  pc_push_round(pc_round_cores(a.p, a.size.x, x, b.size.x, other, margin), m);
}

PC_FN void pc_sphere_box(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Axes axes = pc_axes(b.q);
  RoundContact k = pc_sphere_over_box(a.p, a.size.x, b.p, axes, b.size, margin);
  if (k.apart || !k.open) {
    pc_push_round(k, m);
    return;
  }
  // the centre is inside: out through the nearest face
  Vec3 c = pc_to_local(axes, pc_sub(a.p, b.p));
  precise Vec3 room = b.size - pc_abs3(c);
  uint i = pc_least_component(room);
  m.normal = pc_negate(pc_to_world(axes, pc_unit_axis(i, pc_sign(pc_component(c, i)))));
  precise Real separation = -pc_component(room, i) - a.size.x;
  pc_push_from(m, a.p, m.normal, a.size.x, separation, margin, 0u);
}

PC_FN void pc_sphere_cylinder(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Axes axes = pc_axes(b.q);
  Vec3 c = pc_to_local(axes, pc_sub(a.p, b.p));
  precise Real around = c.x * c.x + c.z * c.z;
  Real rho = pc_sqrt(around);
  Vec3 radial = Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0));
  if (pc_has_length(around)) {
    Real i = pc_div(PC_REAL(1.0), rho);
    precise Real x = c.x * i;
    precise Real z = c.z * i;
    radial = Vec3(x, PC_REAL(0.0), z);
  }
  precise Real beside = rho - b.size.x;
  precise Real above = pc_abs(c.y) - b.size.y;
  Real er = pc_max(beside, PC_REAL(0.0));
  Real ey = pc_max(above, PC_REAL(0.0));
  precise Real squared = er * er + ey * ey;
  Real distance = pc_sqrt(squared);
  Vec3 outward;
  if (pc_has_length(squared)) {
    Real i = pc_div(PC_REAL(1.0), distance);
    precise Real r = er * i;
    precise Real y = ey * i * pc_sign(c.y);
    precise Real x = radial.x * r;
    precise Real z = radial.z * r;
    outward = Vec3(x, y, z);
  } else {
    distance = pc_max(beside, above);
    outward = above >= beside ? Vec3(PC_REAL(0.0), pc_sign(c.y), PC_REAL(0.0)) : radial;
  }
  m.normal = pc_negate(pc_to_world(axes, outward));
  precise Real separation = distance - a.size.x;
  pc_push_from(m, a.p, m.normal, a.size.x, separation, margin, 0u);
}

// Those of the ends of a common stretch that are within the margin. Returns whether there is a point then.
PC_FN bool pc_parallel_points(Round a, Round b, SegmentPair o, Real margin, uint feature, PC_INOUT(NarrowManifold) m) {
  if (o.sine_squared >= PC_PARALLEL_NONE) return false;
  Stretch s = pc_stretch(a, b, o, m.normal);
  if (!s.exists) return false;
  if (s.first_separation <= margin) pc_push(m, s.first, s.first_separation, feature);
  if (s.second_separation <= margin) pc_push(m, s.second, s.second_separation, feature + 1u);
  return m.count > 0u;
}

// ---- against a plane ------------------------------------------------------------------------------------
PC_FN void pc_sphere_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q);
  precise Real separation = pc_dot(up, pc_sub(a.p, b.p)) - a.size.x;
  m.normal = pc_negate(up);
  pc_push_from(m, a.p, m.normal, a.size.x, separation, margin, 0u);
}

PC_FN void pc_capsule_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q);
  Vec3 u = pc_axis_y(a.q);
  Real r = a.size.x;
  Real height = pc_dot(up, pc_sub(a.p, b.p));
  Real slope = pc_dot(up, u);
  m.normal = pc_negate(up);
  for (uint k = 0u; k < 2u; k++) {
    Real t = k == 0u ? -a.size.y : a.size.y;
    precise Real separation = height + slope * t - r;
    pc_push_from(m, pc_madd(a.p, u, t), m.normal, r, separation, margin, k);
  }
}

// The corners of the face that looks most towards the plane; feature = number of the corner.
PC_FN void pc_box_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q);
  Axes axes = pc_axes(a.q);
  Vec3 h = a.size;
  Vec3 l = pc_to_local(axes, up);
  Real height = pc_dot(up, pc_sub(a.p, b.p));
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

// The squared sine of 0.02 degrees: of what leans less, fixed points are right to 1e-4 of the radius.
#define PC_STANDS PC_REAL(1e-7)
// Rim points at four fixed angles, or the exact lowest points where the cylinder leans: the lowest of both
// rims, and the two a quarter turn beside it.
PC_FN void pc_cylinder_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q);
  Axes axes = pc_axes(a.q);
  Real r = a.size.x;
  Real h = a.size.y;
  Vec3 l = pc_to_local(axes, up);
  Real height = pc_dot(up, pc_sub(a.p, b.p));
  m.normal = pc_negate(up);
  precise Real lean_squared = l.x * l.x + l.z * l.z;
  Real bottom = l.y > PC_REAL(0.0) ? -h : h;
  bool leans = lean_squared > PC_STANDS;
  Real ux = PC_REAL(1.0);
  Real uz = PC_REAL(0.0);
  if (leans) {
    Real i = pc_div(PC_REAL(-1.0), pc_sqrt(lean_squared));
    precise Real x = l.x * i;
    precise Real z = l.z * i;
    ux = x;
    uz = z;
  }
  uint base = leans ? 8u : 0u;
  for (uint k = 0u; k < 4u; k++) {
    // k = 0 lowest, 1 and 2 beside, 3 opposite; a leaning cylinder's other rim is nearer than its opposite
    // side when it lies
    Real cx = k == 0u ? ux : (k == 1u ? -uz : (k == 2u ? uz : -ux));
    Real cz = k == 0u ? uz : (k == 1u ? ux : (k == 2u ? -ux : -uz));
    Real y = bottom;
    if (k == 3u && pc_abs(l.y) < PC_ROOT_HALF) {
      cx = ux;
      cz = uz;
      y = -bottom;
    }
    precise Real vx = cx * r;
    precise Real vz = cz * r;
    Vec3 v = Vec3(vx, y, vz);
    precise Real separation = height + pc_dot(l, v);
    pc_push_from(m, pc_add(a.p, pc_to_world(axes, v)), m.normal, PC_REAL(0.0), separation, margin, base + k);
  }
}
