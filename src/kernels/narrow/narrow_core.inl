// Convex shapes as a core with a radius: what GJK, EPA and the general manifold know of a shape.
// D = A - B is the Minkowski difference of two cores; h(n) = max over D of n . w is their overlap along n.

// `reach`: radius of a ball around the core.
struct Core {
  uint kind;
  Vec3 p;
  Axes axes;
  Vec3 size;
  Real radius;
  Real reach;
  HullRef hull;
};
// w = a - b.
struct Support {
  Vec3 w;
  Vec3 a;
};

PC_FN Core pc_core(NarrowShape s) {
  Core c;
  c.kind = s.kind;
  c.p = s.p;
  c.axes = pc_axes(s.q);
  c.size = s.size;
  c.radius = PC_REAL(0.0);
  c.hull = s.hull;
  Vec3 corner = s.size;
  if (s.kind == PC_CAPSULE) {
    c.radius = s.size.x;
    corner = Vec3(PC_REAL(0.0), s.size.y, PC_REAL(0.0));
    c.size = corner;
  }
  if (s.kind == PC_SPHERE) {
    c.radius = s.size.x;
    corner = pc_zero3();
    c.size = corner;
  }
  if (s.kind == PC_HULL) {
    corner = Vec3(s.size.x, PC_REAL(0.0), PC_REAL(0.0));
    c.size = corner;
  }
  if (s.kind == PC_CYLINDER) corner = Vec3(s.size.x, s.size.y, PC_REAL(0.0));
  c.reach = pc_length(corner);
  return c;
}

// The part of a long shape that another within `reach` of `centre` can meet: what lies farther away than any
// way out is cut off, so that a floor of 200 m has numbers of the size of what lies on it.
PC_FN_LARGE NarrowShape pc_window(NarrowShape s, Vec3 centre, Real reach, Real margin) {
  if (s.kind == PC_HULL) return s;
  bool box = s.kind == PC_BOX;
  Vec3 h = box ? s.size : Vec3(PC_REAL(0.0), s.size.y, PC_REAL(0.0));
  Real least = box ? pc_smallest(h) : s.size.x;
  precise Real window = least * PC_REAL(2.0) + pc_four_times(reach) + margin;
  if (pc_largest(h) <= window) return s;
  Axes axes = pc_axes(s.q);
  Vec3 c = pc_to_local(axes, pc_sub(centre, s.p));
  Vec3 all = Vec3(window, window, window);
  precise Vec3 low = c - all;
  precise Vec3 high = c + all;
  Vec3 from = Vec3(pc_max(low.x, -h.x), pc_max(low.y, -h.y), pc_max(low.z, -h.z));
  Vec3 to = Vec3(pc_min(high.x, h.x), pc_min(high.y, h.y), pc_min(high.z, h.z));
  precise Vec3 size = (to - from) * PC_REAL(0.5);
  precise Vec3 shift = (to + from) * PC_REAL(0.5);
  NarrowShape part = s;
  if (box) {
    if (!(pc_smallest(size) > PC_REAL(0.0))) return s;
    part.size = size;
    part.p = pc_add(s.p, pc_to_world(axes, shift));
  } else {
    if (!(size.y > PC_REAL(0.0))) return s;
    part.size = Vec3(s.size.x, size.y, PC_REAL(0.0));
    part.p = pc_madd(s.p, axes.y, shift.y);
  }
  return part;
}

PC_FN Vec3 pc_core_support(Core c, Vec3 d) {
  Vec3 l = pc_to_local(c.axes, d);
  if (c.kind == PC_HULL) return pc_add(c.p, pc_to_world(c.axes, pc_hull_vertex(c.hull, pc_hull_support(c.hull, l))));
  Vec3 v = Vec3(PC_REAL(0.0), l.y < PC_REAL(0.0) ? -c.size.y : c.size.y, PC_REAL(0.0));
  if (c.kind == PC_BOX) {
    v = Vec3(l.x < PC_REAL(0.0) ? -c.size.x : c.size.x, v.y, l.z < PC_REAL(0.0) ? -c.size.z : c.size.z);
  } else if (c.kind == PC_CYLINDER) {
    precise Real squared = l.x * l.x + l.z * l.z;
    if (pc_has_length(squared)) {
      Real i = pc_div(c.size.x, pc_sqrt(squared));
      precise Real x = l.x * i;
      precise Real z = l.z * i;
      v = Vec3(x, v.y, z);
    }
  }
  return pc_add(c.p, pc_to_world(c.axes, v));
}
PC_FN_LARGE Support pc_support(Core a, Core b, Vec3 d) {
  Support s;
  s.a = pc_core_support(a, d);
  s.w = pc_sub(s.a, pc_core_support(b, pc_negate(d)));
  return s;
}
PC_FN Real pc_overlap(Core a, Core b, Vec3 n) { return pc_dot(n, pc_support(a, b, n).w); }
