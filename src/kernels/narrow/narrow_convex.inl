// General convex pairs: normal by GJK or EPA, made exact where a face, side or pair of edges gives it, then the
// features that look along it.

// cosine of a degree, and its sine: a direction is the normal's, and a line lies across it
#define PC_SAME_NORMAL PC_REAL(0.9998)
#define PC_LIES_ALONG PC_REAL(0.02)
// a direction is packed in ten bits a component
#define PC_PACK_HALF PC_REAL(512.0)

// ---- the normal -----------------------------------------------------------------------------------------
// Of the cores: unit normal from a to b, separation along it, point of A.
struct Contact {
  Vec3 n;
  Real gap;
  Vec3 a;
};

// Takes the direction c (or -c) when it lies within a degree of the normal and separates as well.
PC_FN void pc_try_normal(PC_INOUT(Contact) k, Core a, Core b, Vec3 c, Vec3 about, Real slop, PC_INOUT(bool) found) {
  Real along = pc_dot(c, about);
  if (found || !(pc_abs(along) > PC_SAME_NORMAL)) return;
  Vec3 n = along < PC_REAL(0.0) ? pc_negate(c) : c;
  Real gap = -pc_overlap(a, b, n);
  precise Real least = k.gap - slop;
  if (gap >= least) {
    k.n = n;
    k.gap = gap;
    found = true;
  }
}
PC_FN bool pc_has_face(Core c, uint i) {
  return c.kind == PC_BOX || ((c.kind == PC_CYLINDER || c.kind == PC_HULL) && i == 1u);
}
// Normal of face i of a core, which looks along d or against it; a hull has but one that may.
PC_FN Vec3 pc_face_normal(Core c, uint i, Vec3 d) {
  if (c.kind != PC_HULL) return pc_axis(c.axes, i);
  return pc_to_world(c.axes,
                     pc_hull_vec(c.hull, pc_hull_face_row(c.hull, pc_hull_facing(c.hull, pc_to_local(c.axes, d)))));
}
// Edges or axes of a core that could touch along d: three of a box, those of a hull at its farthest vertex.
struct Lines {
  uint count;
  uint vertex;
  uint first;
};
PC_FN Lines pc_core_lines(Core c, Vec3 d) {
  Lines o;
  o.count = c.kind == PC_BOX ? 3u : (c.kind == PC_SPHERE ? 0u : 1u);
  o.vertex = 0u;
  o.first = 0u;
  if (c.kind == PC_HULL) {
    o.vertex = pc_hull_support(c.hull, pc_to_local(c.axes, d));
    o.first = pc_hull_first_neighbour(c.hull, o.vertex);
    o.count = pc_hull_first_neighbour(c.hull, o.vertex + 1u) - o.first;
  }
  return o;
}
PC_FN Vec3 pc_line_direction(Core c, Lines o, uint i) {
  if (c.kind == PC_BOX) return pc_axis(c.axes, i);
  if (c.kind != PC_HULL) return c.axes.y;
  return pc_unit_or_zero(pc_to_world(
      c.axes, pc_sub(pc_hull_vertex(c.hull, pc_hull_index(c.hull, o.first + i)), pc_hull_vertex(c.hull, o.vertex))));
}
PC_FN bool pc_is_round(Core c) { return c.kind == PC_CAPSULE || c.kind == PC_CYLINDER; }
PC_FN bool pc_is_flat(Core c) { return c.kind == PC_BOX || c.kind == PC_HULL; }
PC_FN_LARGE void pc_sharpen(PC_INOUT(Contact) k, Core a, Core b) {
  precise Real slop = (a.reach + b.reach) * PC_SHARPEN_SLOP;
  Vec3 n = k.n;
  bool found = false;
  for (uint i = 0u; i < 3u; i++) {
    if (pc_has_face(a, i)) pc_try_normal(k, a, b, pc_face_normal(a, i, n), n, slop, found);
  }
  for (uint i = 0u; i < 3u; i++) {
    if (pc_has_face(b, i)) pc_try_normal(k, a, b, pc_face_normal(b, i, pc_negate(n)), n, slop, found);
  }
  Lines la;
  Lines lb;
  la.count = 0u;
  if (!found) {
    la = pc_core_lines(a, n);
    lb = pc_core_lines(b, pc_negate(n));
  }
  for (uint i = 0u; i < la.count && !found; i++) {
    Vec3 u = pc_line_direction(a, la, i);
    for (uint j = 0u; j < lb.count; j++) {
      Vec3 c = pc_cross(u, pc_line_direction(b, lb, j));
      Real squared = pc_dot(c, c);
      if (squared > PC_LITTLE)
        pc_try_normal(k, a, b, pc_scale(c, pc_div(PC_REAL(1.0), pc_sqrt(squared))), n, slop, found);
    }
  }
  // beside a round side: square to its axis, straight at the other's axis or corner
  for (uint side = 0u; side < 2u; side++) {
    Vec3 y = side == 0u ? a.axes.y : b.axes.y;
    bool round_ = side == 0u ? pc_is_round(a) : pc_is_round(b);
    if (round_ && !found) {
      Vec3 own = side == 0u ? a.p : b.p;
      Vec3 other = side == 0u ? b.p : a.p;
      if (side == 0u && pc_is_flat(b)) other = pc_core_support(b, pc_negate(n));
      if (side == 1u && pc_is_flat(a)) other = pc_core_support(a, n);
      Vec3 d = pc_sub(other, own);
      pc_try_normal(k, a, b, pc_unit_or_zero(pc_madd(d, y, -pc_dot(d, y))), n, slop, found);
      pc_try_normal(k, a, b, pc_unit_or_zero(pc_madd(n, y, -pc_dot(n, y))), n, slop, found);
    }
  }
}

// ---- points ---------------------------------------------------------------------------------------------
// What of core b lies over face fa of core a; `n`: the normal from a to b,
// `flat_a`: the cosine between it and that of the face.
PC_FN void pc_points_over(Core a, Face fa, Core b, Face fb, Vec3 n, Real flat_a, Real margin, uint side,
                          PC_INOUT(NarrowManifold) m) {
  Over o;
  o.n = n;
  o.fn = fa.n;
  o.slant = pc_div(PC_REAL(1.0), flat_a);
  Pads pads;
  pads.reference = a.radius;
  pads.incident = b.radius;
  uint tag = side + pc_face_tag(fa, fb);
  if (fb.sides > 0u)
    pc_face_over_face(fa, fb, o, pads, margin, tag, m);
  else
    pc_line_over_face(fa, pc_core_line(b, pc_negate(n)), o, pads, margin, tag, m);
}
PC_FN Round pc_line_core(Line line, Real radius) {
  Round r;
  r.p = line.c;
  r.r = radius;
  r.u = line.u;
  r.h = line.h;
  return r;
}
// Where no face does: edges, sides or axes that run together.
PC_FN void pc_points_along(Core a, Core b, Vec3 n, Real margin, PC_INOUT(NarrowManifold) m) {
  Line la = pc_core_line(a, n);
  Line lb = pc_core_line(b, pc_negate(n));
  bool along = pc_abs(pc_dot(la.u, n)) < PC_LIES_ALONG && pc_abs(pc_dot(lb.u, n)) < PC_LIES_ALONG;
  if (!along) return;
  SegmentPair s = pc_closest_segments(la.c, la.u, la.h, lb.c, lb.u, lb.h);
  pc_parallel_points(pc_line_core(la, a.radius), pc_line_core(lb, b.radius), s, margin, 0x3000001u, m);
}
// The closest point itself, where nothing else holds it: instead of the shallowest of four.
PC_FN void pc_hold_closest(Vec3 closest, Contact k, Core a, Core b, Real margin, PC_INOUT(NarrowManifold) m) {
  precise Real separation = k.gap - a.radius - b.radius;
  Real held_slop = m.count == 4u && separation < PC_REAL(0.0) ? PC_FLAT_SLOP : PC_HELD_SLOP;
  precise Real deepest = separation + pc_min(a.reach, b.reach) * held_slop;
  bool held = false;
  uint shallowest = 0u;
  for (uint i = 0u; i < m.count; i++) {
    held = held || m.points[i].separation <= deepest;
    if (m.points[i].separation > m.points[shallowest].separation) shallowest = i;
  }
  if (held || separation > margin) return;
  if (m.count == 4u) {
    m.count = 3u;
    m.points[shallowest] = m.points[3];
  }
  pc_push_from(m, closest, k.n, a.radius, separation, margin, 0x3000000u);
}

PC_FN_LARGE void pc_convex_points(Contact k, Core a, Core b, Real margin, PC_INOUT(NarrowManifold) m) {
  m.normal = k.n;
  Vec3 against = pc_negate(k.n);
  Face fa = pc_core_face(a, k.n);
  Face fb = pc_core_face(b, against);
  Real flat_a = fa.sides > 0u ? pc_dot(fa.n, k.n) : PC_REAL(0.0);
  Real flat_b = fb.sides > 0u ? -pc_dot(fb.n, k.n) : PC_REAL(0.0);
  bool use_a = flat_a > PC_FACE_FLAT;
  bool use_b = flat_b > PC_FACE_FLAT;
  if (use_a && use_b) {  // the larger
    precise Real area_a = fa.h1 * fa.h2;
    precise Real area_b = fb.h1 * fb.h2;
    use_b = area_b > area_a;
    use_a = !use_b;
  }
  if (use_a)
    pc_points_over(a, fa, b, fb, k.n, flat_a, margin, 0x1000000u, m);
  else if (use_b)
    pc_points_over(b, fb, a, fa, against, flat_b, margin, 0x2000000u, m);
  else
    pc_points_along(a, b, k.n, margin, m);
  // over a face the closest point is what stands out farthest, which does not depend on how the search went; what lies
  // beside the face may stand out anywhere
  Vec3 closest = k.a;
  if (m.count > 0u && use_a)
    closest = pc_madd(pc_core_support(b, against), k.n, -k.gap);
  else if (m.count > 0u && use_b)
    closest = pc_core_support(a, k.n);
  pc_hold_closest(closest, k, a, b, margin, m);
}

// ---- the pair -------------------------------------------------------------------------------------------
// A direction in 30 bits of a hint, marked by the highest.
PC_FN uint pc_pack_part(Real x) {
  precise Real t = x * (PC_PACK_HALF - PC_REAL(1.0)) + PC_PACK_HALF;
  return uint(t);
}
PC_FN uint pc_pack_direction(Vec3 n) {
  return 0x80000000u | (pc_pack_part(n.x) << 20u) | (pc_pack_part(n.y) << 10u) | pc_pack_part(n.z);
}
PC_FN Real pc_unpack_part(uint x) {
  precise Real t = Real(x & 1023u) - PC_PACK_HALF;
  return t;
}
PC_FN Vec3 pc_unpack_direction(uint k) {
  return pc_unit_or_zero(Vec3(pc_unpack_part(k >> 20u), pc_unpack_part(k >> 10u), pc_unpack_part(k)));
}

PC_FN_LARGE void pc_convex(NarrowShape sa, NarrowShape sb, Real margin, PC_INOUT(uint) hint,
                           PC_INOUT(NarrowManifold) m) {
  Core a = pc_core(sa);
  Core b = pc_core(sb);
  precise Real around_a = a.reach + a.radius;
  precise Real around_b = b.reach + b.radius;
  a = pc_core(pc_window(sa, sb.p, around_b, margin));
  b = pc_core(pc_window(sb, sa.p, around_a, margin));
  precise Real farthest = margin + a.radius + b.radius;
  precise Real size = a.reach + b.reach;
  precise Real touch = size * PC_CORE_TOUCH;
  if ((hint & 0x80000000u) != 0u) {  // may only end the search where it would end without: by more than its error
    precise Real surely = farthest + touch;
    Vec3 n = pc_unpack_direction(hint);
    if (-pc_overlap(a, b, n) > surely) return;
  }
  Vec3 start = pc_unit_or_zero(pc_sub(b.p, a.p));
  if (!(pc_dot(start, start) > PC_REAL(0.5))) start = Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  Distance d = pc_distance(a, b, start, farthest, touch);
  if (d.separated) {
    hint = pc_pack_direction(pc_negate(pc_unit_or_zero(d.v)));
    return;
  }
  Contact k;
  if (d.touching) {
    Penetration p = pc_penetration(a, b, start);
    k.n = p.n;
    k.gap = -p.h;
    k.a = p.a;
  } else {
    Real distance = pc_length(d.v);
    k.n = pc_scale(d.v, pc_div(PC_REAL(-1.0), distance));
    k.gap = distance;
    k.a = d.a;
  }
  pc_sharpen(k, a, b);
  pc_convex_points(k, a, b, margin, m);
}
