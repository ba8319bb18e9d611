// General convex pairs: normal by GJK or EPA, made exact where a face, side or pair of edges gives it, then the
// features that look along it.

// cosine of a degree, and its sine: a direction is the normal's, and a line lies across it
#define PC_SAME_NORMAL PC_REAL(0.9998)
#define PC_LIES_ALONG PC_REAL(0.02)
// of an eighth of a half turn: a rim of eight sides
#define PC_COS_EIGHTH PC_REAL(0.92387953251128674)
#define PC_SIN_EIGHTH PC_REAL(0.38268343236508977)
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

// ---- features -------------------------------------------------------------------------------------------
// A rectangle of half sides h1 and h2, a disc of that radius, which clips as an octagon, or face `id` of a hull.
// Kind: of its core; sides: 0 for no face.
struct Face {
  uint kind;
  uint sides;
  Vec3 c;
  Vec3 n;
  Vec3 e1;
  Vec3 e2;
  Real h1;
  Real h2;
  uint id;
  HullRef hull;
};
struct Line {
  Vec3 c;
  Vec3 u;
  Real h;
};

PC_FN_LARGE Face pc_core_face(Core c, Vec3 d) {
  Face f;
  f.kind = c.kind;
  f.hull = c.hull;
  f.sides = 0u;
  f.c = c.p;
  f.n = d;
  f.e1 = c.axes.z;
  f.e2 = c.axes.x;
  f.h1 = c.size.x;
  f.h2 = c.size.x;
  f.id = 0u;
  Vec3 l = pc_to_local(c.axes, d);
  uint i = 1u;
  if (c.kind == PC_HULL) {
    f.id = pc_hull_facing(c.hull, l);
    f.sides = pc_hull_sides(c.hull, f.id);
    uint row = pc_hull_face_row(c.hull, f.id);
    f.n = pc_to_world(c.axes, pc_hull_vec(c.hull, row));
    f.e1 = pc_to_world(c.axes, pc_hull_vec(c.hull, row + 3u));
    f.e2 = pc_to_world(c.axes, pc_hull_vec(c.hull, row + 6u));
    f.c = pc_add(c.p, pc_to_world(c.axes, pc_hull_vec(c.hull, row + 9u)));
    f.h1 = pc_hull_real(c.hull, row + 12u);
    f.h2 = f.h1;
    return f;
  }
  if (c.kind == PC_BOX) {
    i = pc_greatest_component(pc_abs3(l));
    uint i1 = pc_next(i);
    uint i2 = pc_next(i1);
    f.sides = 4u;
    f.e1 = pc_axis(c.axes, i1);
    f.e2 = pc_axis(c.axes, i2);
    f.h1 = pc_component(c.size, i1);
    f.h2 = pc_component(c.size, i2);
  } else if (c.kind == PC_CYLINDER && pc_abs(l.y) > PC_ROOT_HALF) {
    f.sides = 8u;
  } else {
    return f;
  }
  bool back = pc_component(l, i) < PC_REAL(0.0);
  Vec3 axis = pc_axis(c.axes, i);
  Real h = pc_component(c.size, i);
  f.n = back ? pc_negate(axis) : axis;
  f.c = pc_madd(c.p, axis, back ? -h : h);
  f.id = back ? i * 2u : i * 2u + 1u;
  return f;
}
// The edge, side or axis of a core that looks along d.
PC_FN_LARGE Line pc_core_line(Core c, Vec3 d) {
  Line o;
  o.c = c.p;
  o.u = c.axes.y;
  o.h = c.size.y;
  Vec3 l = pc_to_local(c.axes, d);
  if (c.kind == PC_HULL) {
    uint v = pc_hull_support(c.hull, l);
    Vec3 from = pc_hull_vertex(c.hull, v);
    Vec3 to = pc_hull_vertex(c.hull, pc_hull_edge(c.hull, v, l));
    precise Vec3 middle = (from + to) * PC_REAL(0.5);
    precise Vec3 half_edge = (to - from) * PC_REAL(0.5);
    o.c = pc_add(c.p, pc_to_world(c.axes, middle));
    o.h = pc_length(half_edge);
    o.u = pc_unit_or_zero(pc_to_world(c.axes, half_edge));
  } else if (c.kind == PC_BOX) {
    uint i = pc_least_component(l);
    o.u = pc_axis(c.axes, i);
    o.h = pc_component(c.size, i);
    o.c = pc_add(c.p, pc_to_world(c.axes, pc_edge_middle(c.size, i, l)));
  } else if (c.kind == PC_CYLINDER) {
    precise Real squared = l.x * l.x + l.z * l.z;
    if (pc_has_length(squared)) {
      Real i = pc_div(c.size.x, pc_sqrt(squared));
      precise Real x = l.x * i;
      precise Real z = l.z * i;
      o.c = pc_add(c.p, pc_to_world(c.axes, Vec3(x, PC_REAL(0.0), z)));
    }
  }
  return o;
}

// ---- points ---------------------------------------------------------------------------------------------
// Reference face and what lies over it, projected along n (from the reference to the other shape).
// Slant = 1 / (n . fn)
struct Over {
  Vec3 n;
  Vec3 fn;
  Real slant;
};
PC_FN Vec3 pc_flat(Over o, Vec3 v) {
  precise Real s = -pc_dot(v, o.fn) * o.slant;
  return pc_madd(v, o.n, s);
}

PC_FN uint pc_polygon(PC_INOUT(NarrowPolygon) polygon, Face f) {
  polygon.count = f.sides;
  if (f.kind == PC_HULL) {
    pc_hull_polygon(f.hull, f.id, polygon);
  } else if (f.kind == PC_BOX) {
    polygon.x[0] = -f.h1;
    polygon.y[0] = -f.h2;
    polygon.x[1] = f.h1;
    polygon.y[1] = -f.h2;
    polygon.x[2] = f.h1;
    polygon.y[2] = f.h2;
    polygon.x[3] = -f.h1;
    polygon.y[3] = f.h2;
  } else {
    precise Real k = f.h1 * PC_ROOT_HALF;
    Real r = f.h1;
    Real zero = PC_REAL(0.0);
    polygon.x[0] = r;
    polygon.y[0] = zero;
    polygon.x[1] = k;
    polygon.y[1] = k;
    polygon.x[2] = zero;
    polygon.y[2] = r;
    polygon.x[3] = -k;
    polygon.y[3] = k;
    polygon.x[4] = -r;
    polygon.y[4] = zero;
    polygon.x[5] = -k;
    polygon.y[5] = -k;
    polygon.x[6] = zero;
    polygon.y[6] = -r;
    polygon.x[7] = k;
    polygon.y[7] = -k;
  }
  for (uint i = 0u; i < f.sides; i++) polygon.id[i] = ((i == 0u ? f.sides - 1u : i - 1u) << 5u) | i;
  return f.sides;
}

// Side k of a face: the half-plane x cosine + y sine <= off.
PC_FN Vec3 pc_side(Face f, uint k) {
  if (f.kind == PC_HULL) return pc_hull_vec(f.hull, pc_hull_first_side(f.hull, f.id) + k * PC_HULL_SIDE_REALS + 2u);
  if (f.kind == PC_BOX) {
    if (k == 0u) return Vec3(PC_REAL(1.0), PC_REAL(0.0), f.h1);
    if (k == 1u) return Vec3(PC_REAL(0.0), PC_REAL(1.0), f.h2);
    if (k == 2u) return Vec3(PC_REAL(-1.0), PC_REAL(0.0), f.h1);
    return Vec3(PC_REAL(0.0), PC_REAL(-1.0), f.h2);
  }
  Real c = PC_COS_EIGHTH;
  Real s = PC_SIN_EIGHTH;
  precise Real off = f.h1 * c;
  uint q = k & 1u;
  Real x = q == 0u ? c : s;
  Real y = q == 0u ? s : c;
  if (k == 0u || k == 1u) return Vec3(x, y, off);
  if (k == 2u || k == 3u) return Vec3(-y, x, off);
  if (k == 4u || k == 5u) return Vec3(-x, -y, off);
  return Vec3(y, -x, off);
}

// Radii of the two cores.
struct Pads {
  Real reference;
  Real incident;
};
PC_FN void pc_push_over(PC_INOUT(NarrowManifold) m, Vec3 x, Over o, Real gap, Pads pads, Real margin, uint feature) {
  precise Real separation = gap - pads.reference - pads.incident;
  precise Real back = (pads.reference - pads.incident - gap) * PC_REAL(0.5);
  if (separation <= margin && m.count < 4u) pc_push(m, pc_madd(x, o.n, back), separation, feature);
}

PC_FN_LARGE void pc_face_over_face(Face reference, Face f, Over o, Pads pads, Real margin, uint tag,
                                   PC_INOUT(NarrowManifold) m) {
  NarrowPolygon polygon;
  uint corners = pc_polygon(polygon, f);
  Vec3 c = pc_sub(f.c, reference.c);
  Vec3 c0 = pc_flat(o, c);
  Vec3 e1 = pc_flat(o, f.e1);
  Vec3 e2 = pc_flat(o, f.e2);
  Real x0 = pc_dot(c0, reference.e1);
  Real x1 = pc_dot(e1, reference.e1);
  Real x2 = pc_dot(e2, reference.e1);
  Real y0 = pc_dot(c0, reference.e2);
  Real y1 = pc_dot(e1, reference.e2);
  Real y2 = pc_dot(e2, reference.e2);
  precise Real slop = pc_min(pc_min(reference.h1, reference.h2), pc_min(f.h1, f.h2)) * PC_CLIP_SLOP;
  for (uint k = 0u; k < reference.sides; k++) {
    Vec3 s = pc_side(reference, k);
    precise Real a = s.x * x1 + s.y * y1;
    precise Real b = s.x * x2 + s.y * y2;
    precise Real off = s.z - s.x * x0 - s.y * y0;
    pc_clip(polygon, a, b, off, slop, 16u + k);
  }
  precise Real g0 = pc_dot(c, o.fn) * o.slant;
  precise Real g1 = pc_dot(f.e1, o.fn) * o.slant;
  precise Real g2 = pc_dot(f.e2, o.fn) * o.slant;
  for (uint i = 0u; i < polygon.count; i++) {
    precise Real s = g0 + g1 * polygon.x[i] + g2 * polygon.y[i];
    polygon.s[i] = s;
  }
  precise Real farthest = margin + pads.reference + pads.incident;
  precise Real rocking = pc_min(f.h1, f.h2) * PC_FLAT_SLOP;
  pc_reduce(polygon, farthest, rocking);
  for (uint i = 0u; i < polygon.count; i++) {
    Vec3 x = pc_combine(f.e1, polygon.x[i], f.e2, polygon.y[i], f.c, PC_REAL(1.0));
    uint corner = polygon.id[i];
    pc_push_over(m, x, o, polygon.s[i], pads, margin, tag + ((corners & 15u) << 12u) + corner);
  }
}

PC_FN_LARGE void pc_line_over_face(Face reference, Line line, Over o, Pads pads, Real margin, uint tag,
                                   PC_INOUT(NarrowManifold) m) {
  Vec3 c = pc_sub(line.c, reference.c);
  Vec3 c0 = pc_flat(o, c);
  Vec3 u = pc_flat(o, line.u);
  Real low = -line.h;
  Real high = line.h;
  Real cx = pc_dot(c0, reference.e1);
  Real cy = pc_dot(c0, reference.e2);
  Real ux = pc_dot(u, reference.e1);
  Real uy = pc_dot(u, reference.e2);
  if (reference.kind != PC_CYLINDER) {
    for (uint k = 0u; k < reference.sides; k++) {
      Vec3 s = pc_side(reference, k);
      precise Real slope = s.x * ux + s.y * uy;
      precise Real room = s.z - s.x * cx - s.y * cy;
      if (pc_abs(slope) > PC_SLIGHT) {
        Real t = pc_div(room, slope);
        if (slope > PC_REAL(0.0))
          high = pc_min(high, t);
        else
          low = pc_max(low, t);
      } else if (room < PC_REAL(0.0)) {
        high = low;
      }
    }
  } else {
    // |c + u t| <= radius
    precise Real uu = ux * ux + uy * uy;
    precise Real uc = ux * cx + uy * cy;
    precise Real cc = cx * cx + cy * cy - reference.h1 * reference.h1;
    precise Real discriminant = uc * uc - uu * cc;
    if (uu > PC_SLIGHT) {
      Real root = pc_sqrt(pc_max(discriminant, PC_REAL(0.0)));
      precise Real t0 = -uc - root;
      precise Real t1 = root - uc;
      low = pc_max(low, pc_div(t0, uu));
      high = pc_min(high, pc_div(t1, uu));
      if (discriminant <= PC_REAL(0.0)) high = low;
    }
  }
  if (!(high > low)) return;
  Real g0 = pc_dot(c, o.fn);
  Real g1 = pc_dot(line.u, o.fn);
  for (uint k = 0u; k < 2u; k++) {
    Real t = k == 0u ? low : high;
    precise Real gap = (g0 + g1 * t) * o.slant;
    pc_push_over(m, pc_madd(line.c, line.u, t), o, gap, pads, margin, tag + k);
  }
}

// Numbers of both faces, up to 127 each, beside the bits of corners (0 to 15) and of which shape has the reference (24,
// 25).
PC_FN uint pc_face_tag(Face reference, Face incident) {
  return ((reference.id & 15u) << 16u) | ((incident.id & 15u) << 20u) | ((reference.id >> 4u) << 26u) |
         ((incident.id >> 4u) << 29u);
}

PC_FN_LARGE void pc_convex_points(Contact k, Core a, Core b, Real margin, PC_INOUT(NarrowManifold) m) {
  m.normal = k.n;
  Face fa = pc_core_face(a, k.n);
  Face fb = pc_core_face(b, pc_negate(k.n));
  Real flat_a = fa.sides > 0u ? pc_dot(fa.n, k.n) : PC_REAL(0.0);
  Real flat_b = fb.sides > 0u ? -pc_dot(fb.n, k.n) : PC_REAL(0.0);
  bool use_a = flat_a > PC_FACE_FLAT;
  bool use_b = flat_b > PC_FACE_FLAT;
  if (use_a && use_b) {  // the larger
    precise Real area_a = fa.h1 * fa.h2;
    precise Real area_b = fb.h1 * fb.h2;
    if (area_b > area_a)
      use_a = false;
    else
      use_b = false;
  }
  Over o;
  Pads pads;
  if (use_a) {
    o.n = k.n;
    o.fn = fa.n;
    o.slant = pc_div(PC_REAL(1.0), flat_a);
    pads.reference = a.radius;
    pads.incident = b.radius;
    uint tag = 0x1000000u + pc_face_tag(fa, fb);
    if (fb.sides > 0u)
      pc_face_over_face(fa, fb, o, pads, margin, tag, m);
    else
      pc_line_over_face(fa, pc_core_line(b, pc_negate(k.n)), o, pads, margin, tag, m);
  } else if (use_b) {
    o.n = pc_negate(k.n);
    o.fn = fb.n;
    o.slant = pc_div(PC_REAL(1.0), flat_b);
    pads.reference = b.radius;
    pads.incident = a.radius;
    uint tag = 0x2000000u + pc_face_tag(fb, fa);
    if (fa.sides > 0u)
      pc_face_over_face(fb, fa, o, pads, margin, tag, m);
    else
      pc_line_over_face(fb, pc_core_line(a, k.n), o, pads, margin, tag, m);
  } else {
    Line la = pc_core_line(a, k.n);
    Line lb = pc_core_line(b, pc_negate(k.n));
    SegmentPair s = pc_closest_segments(la.c, la.u, la.h, lb.c, lb.u, lb.h);
    bool along = pc_abs(pc_dot(la.u, k.n)) < PC_LIES_ALONG && pc_abs(pc_dot(lb.u, k.n)) < PC_LIES_ALONG;
    Round core_a;
    core_a.p = la.c;
    core_a.r = a.radius;
    core_a.u = la.u;
    core_a.h = la.h;
    Round core_b;
    core_b.p = lb.c;
    core_b.r = b.radius;
    core_b.u = lb.u;
    core_b.h = lb.h;
    if (along) pc_parallel_points(core_a, core_b, s, margin, 0x3000001u, m);
  }
  // the closest point itself, where nothing else holds it: instead of the shallowest of four. Over a face it is
  // what stands out farthest, which does not depend on how the search went; what lies beside the face may stand out
  // anywhere
  Vec3 closest = k.a;
  if (m.count > 0u && use_a)
    closest = pc_madd(pc_core_support(b, pc_negate(k.n)), k.n, -k.gap);
  else if (m.count > 0u && use_b)
    closest = pc_core_support(a, k.n);
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
