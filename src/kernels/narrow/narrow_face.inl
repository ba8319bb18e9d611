// Features of cores that look along a normal, and what of one core lies over a face of the other.

// of an eighth of a half turn: a rim of eight sides
#define PC_COS_EIGHTH PC_REAL(0.92387953251128674)
#define PC_SIN_EIGHTH PC_REAL(0.38268343236508977)

// A rectangle of half sides h1 and h2, a disc of that radius, which clips as an octagon, or face `id` of a hull.
// `kind`: of its core; `sides`: 0 for no face.
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
// `slant` is 1 / (n . fn).
struct Over {
  Vec3 n;
  Vec3 fn;
  Real slant;
};
PC_FN Vec3 pc_flat(Over o, Vec3 v) {
  precise Real s = -pc_dot(v, o.fn) * o.slant;
  return pc_madd(v, o.n, s);
}

PC_FN void pc_octagon(PC_INOUT(NarrowPolygon) polygon, Real r) {
  precise Real k = r * PC_ROOT_HALF;
  Real zero = PC_REAL(0.0);
  pc_put_corner(polygon, 0u, r, zero);
  pc_put_corner(polygon, 1u, k, k);
  pc_put_corner(polygon, 2u, zero, r);
  pc_put_corner(polygon, 3u, -k, k);
  pc_put_corner(polygon, 4u, -r, zero);
  pc_put_corner(polygon, 5u, -k, -k);
  pc_put_corner(polygon, 6u, zero, -r);
  pc_put_corner(polygon, 7u, k, -k);
}
PC_FN uint pc_polygon(PC_INOUT(NarrowPolygon) polygon, Face f) {
  polygon.count = f.sides;
  if (f.kind == PC_HULL)
    pc_hull_polygon(f.hull, f.id, polygon);
  else if (f.kind == PC_BOX)
    pc_rectangle(polygon, f.h1, f.h2);
  else
    pc_octagon(polygon, f.h1);
  pc_number_edges(polygon, f.sides);
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

// Numbers of both faces, up to 127 each, beside the bits of corners (0 to 15) and of which shape has
// the reference (24, 25).
PC_FN uint pc_face_tag(Face reference, Face incident) {
  return ((reference.id & 15u) << 16u) | ((incident.id & 15u) << 20u) | ((reference.id >> 4u) << 26u) |
         ((incident.id >> 4u) << 29u);
}
