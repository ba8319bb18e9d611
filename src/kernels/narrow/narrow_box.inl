// Two boxes: separating axes (S. Gottschalk et al., OBB-Tree, 1996), then the incident face clipped by the
// reference face, or the two crossing edges.
//
// The larger face is the reference one, so that a small box on a floor of 200 m is clipped in its own
// coordinates and its corners keep their digits.

struct BoxPair {
  Axes a;
  Axes b;
  Vec3 ha;
  Vec3 hb;
  // centre of b from a: origin's axes, a's, b's
  Vec3 d;
  Vec3 da;
  Vec3 db;
  // b's axes in a's: r_i = (a_i . b_x, a_i . b_y, a_i . b_z)
  Vec3 rx;
  Vec3 ry;
  Vec3 rz;
  // their absolute values
  Vec3 ax;
  Vec3 ay;
  Vec3 az;
};

PC_FN BoxPair pc_box_pair(NarrowShape a, NarrowShape b) {
  BoxPair k;
  k.a = pc_axes(a.q);
  k.b = pc_axes(b.q);
  k.ha = a.size;
  k.hb = b.size;
  k.d = pc_sub(b.p, a.p);
  k.da = pc_to_local(k.a, k.d);
  k.db = pc_to_local(k.b, k.d);
  k.rx = pc_to_local(k.b, k.a.x);
  k.ry = pc_to_local(k.b, k.a.y);
  k.rz = pc_to_local(k.b, k.a.z);
  k.ax = pc_abs3(k.rx);
  k.ay = pc_abs3(k.ry);
  k.az = pc_abs3(k.rz);
  return k;
}
PC_FN Vec3 pc_row(BoxPair k, uint i) {
  if (i == 0u) return k.rx;
  if (i == 1u) return k.ry;
  return k.rz;
}
PC_FN Real pc_turn(BoxPair k, uint i, uint j) { return pc_component(pc_row(k, i), j); }

// Separation along face axis 0 to 2 of a, 3 to 5 of b.
PC_FN Real pc_face_gap(BoxPair k, uint axis) {
  Real far = PC_REAL(0.0);
  Real own = PC_REAL(0.0);
  Real other = PC_REAL(0.0);
  if (axis < 3u) {
    Vec3 r = pc_abs3(pc_row(k, axis));
    precise Real reach = k.hb.x * r.x + k.hb.y * r.y + k.hb.z * r.z;
    far = pc_component(k.da, axis);
    own = pc_component(k.ha, axis);
    other = reach;
  } else {
    uint j = axis - 3u;
    precise Real reach =
        k.ha.x * pc_component(k.ax, j) + k.ha.y * pc_component(k.ay, j) + k.ha.z * pc_component(k.az, j);
    far = pc_component(k.db, j);
    own = pc_component(k.hb, j);
    other = reach;
  }
  precise Real gap = pc_abs(far) - own - other;
  return gap;
}

// The separation is numerator / sqrt(squared).
struct EdgeGap {
  Real numerator;
  Real squared;
  Real along;
};
// Axis a_i x b_j.
PC_FN EdgeGap pc_edge_gap(BoxPair k, uint i, uint j) {
  uint i1 = pc_next(i);
  uint i2 = pc_next(i1);
  uint j1 = pc_next(j);
  uint j2 = pc_next(j1);
  Real r1 = pc_turn(k, i1, j);
  Real r2 = pc_turn(k, i2, j);
  EdgeGap e;
  precise Real along = pc_component(k.da, i2) * r1 - pc_component(k.da, i1) * r2;
  precise Real reach = pc_component(k.ha, i1) * pc_abs(r2) + pc_component(k.ha, i2) * pc_abs(r1) +
                       pc_component(k.hb, j1) * pc_abs(pc_turn(k, i, j2)) +
                       pc_component(k.hb, j2) * pc_abs(pc_turn(k, i, j1));
  precise Real numerator = pc_abs(along) - reach;
  precise Real squared = r1 * r1 + r2 * r2;
  e.along = along;
  e.numerator = numerator;
  e.squared = squared;
  return e;
}

// Axis 0 to 2 is a face's of a, 3 to 5 of b, 6 + 3 i + j is a_i x b_j; `beat`: what the next axis must exceed.
struct BoxAxis {
  Real gap;
  Real beat;
  uint axis;
};
PC_FN void pc_try_face(BoxPair k, uint axis, PC_INOUT(BoxAxis) best) {
  Real gap = pc_face_gap(k, axis);
  if (gap > best.beat) {
    best.gap = gap;
    best.beat = gap;
    best.axis = axis;
  }
}
// Of the three from `first` on.
PC_FN BoxAxis pc_best_face(BoxPair k, uint first) {
  BoxAxis best;
  best.gap = pc_face_gap(k, first);
  best.beat = best.gap;
  best.axis = first;
  pc_try_face(k, first + 1u, best);
  pc_try_face(k, first + 2u, best);
  return best;
}
PC_FN void pc_try_edge(BoxPair k, uint i, uint j, PC_INOUT(BoxAxis) best) {
  EdgeGap e = pc_edge_gap(k, i, j);
  precise Real numerator2 = e.numerator * e.numerator;
  precise Real beat2 = best.beat * best.beat * e.squared;
  bool better = e.numerator >= PC_REAL(0.0) ? (best.beat < PC_REAL(0.0) || numerator2 > beat2)
                                            : (best.beat < PC_REAL(0.0) && numerator2 < beat2);
  if (better && e.squared > PC_PARALLEL_EXACT) {
    Real gap = pc_div(e.numerator, pc_sqrt(e.squared));
    best.gap = gap;
    best.beat = gap;
    best.axis = 6u + i * 3u + j;
  }
}
PC_FN void pc_try_edges(BoxPair k, PC_INOUT(BoxAxis) best) {
  pc_try_edge(k, 0u, 0u, best);
  pc_try_edge(k, 0u, 1u, best);
  pc_try_edge(k, 0u, 2u, best);
  pc_try_edge(k, 1u, 0u, best);
  pc_try_edge(k, 1u, 1u, best);
  pc_try_edge(k, 1u, 2u, best);
  pc_try_edge(k, 2u, 0u, best);
  pc_try_edge(k, 2u, 1u, best);
  pc_try_edge(k, 2u, 2u, best);
}

// The hint is an axis of an earlier call. It may only end the search early, where the full search would too.
PC_FN bool pc_hint_separates(BoxPair k, uint axis, Real margin, Real slop) {
  if (axis < 6u) return pc_face_gap(k, axis) > margin;
  uint e = axis - 6u;
  EdgeGap gap = pc_edge_gap(k, e / 3u, e % 3u);
  if (!(gap.squared > PC_PARALLEL_EXACT)) return false;
  precise Real surely = margin + slop * PC_REAL(2.0);
  return pc_div(gap.numerator, pc_sqrt(gap.squared)) > surely;
}

PC_FN Real pc_face_area(Vec3 h, uint axis) {
  uint i = pc_next(axis);
  precise Real area = pc_component(h, i) * pc_component(h, pc_next(i));
  return area;
}

// Centre of a face, its two directions, and half its sides along them.
struct BoxFace {
  uint id;
  Vec3 c;
  Vec3 e1;
  Vec3 e2;
  Real h1;
  Real h2;
};
// The one that looks most against fn.
PC_FN BoxFace pc_incident_face(Vec3 x, Axes axes, Vec3 h, Vec3 fn) {
  Vec3 look = pc_to_local(axes, fn);
  uint i = pc_greatest_component(pc_abs3(look));
  bool up = pc_component(look, i) < PC_REAL(0.0);
  uint i1 = pc_next(i);
  uint i2 = pc_next(i1);
  Real lift = pc_component(h, i);
  BoxFace f;
  f.id = up ? i * 2u + 1u : i * 2u;
  f.c = pc_madd(x, pc_axis(axes, i), up ? lift : -lift);
  f.e1 = pc_axis(axes, i1);
  f.e2 = pc_axis(axes, i2);
  f.h1 = pc_component(h, i1);
  f.h2 = pc_component(h, i2);
  return f;
}
// Two opposite sides of the reference face, `edge` at h along u and edge + 2 at -h, in the incident face's coordinates,
// whose centre is at c; those that cut nothing are passed over.
PC_FN void pc_clip_between(PC_INOUT(NarrowPolygon) polygon, BoxFace f, Vec3 c, Vec3 u, Real h, uint edge) {
  Real along = pc_dot(c, u);
  Real a = pc_dot(f.e1, u);
  Real b = pc_dot(f.e2, u);
  precise Real extent = pc_abs(a) * f.h1 + pc_abs(b) * f.h2;
  precise Real slop = pc_min(h, extent) * PC_CLIP_SLOP;
  precise Real over = along + extent - h;
  precise Real under = extent - along - h;
  precise Real before = h - along;
  precise Real behind = h + along;
  if (over > slop) pc_clip(polygon, a, b, before, slop, edge);
  if (under > slop) pc_clip(polygon, -a, -b, behind, slop, edge + 2u);
}

// Incident face of one box against face `axis` of the reference one; fn is the outward normal of the latter.
PC_FN_LARGE void pc_box_faces(Vec3 xr, Axes reference, Vec3 hr, uint axis, Vec3 fn, Vec3 xi, Axes incident, Vec3 hi,
                              Real gap, Real margin, uint tag, PC_INOUT(NarrowManifold) m) {
  BoxFace f = pc_incident_face(xi, incident, hi, fn);
  Vec3 c = pc_sub(f.c, xr);
  uint r1 = pc_next(axis);
  uint r2 = pc_next(r1);
  NarrowPolygon polygon;
  pc_rectangle(polygon, f.h1, f.h2);
  pc_number_edges(polygon, 4u);
  pc_clip_between(polygon, f, c, pc_axis(reference, r1), pc_component(hr, r1), 16u);
  pc_clip_between(polygon, f, c, pc_axis(reference, r2), pc_component(hr, r2), 17u);

  Real g1 = pc_dot(f.e1, fn);
  Real g2 = pc_dot(f.e2, fn);
  precise Real g0 = pc_dot(c, fn) - pc_component(hr, axis);
  for (uint i = 0u; i < polygon.count; i++) {
    precise Real s = g0 + g1 * polygon.x[i] + g2 * polygon.y[i];
    polygon.s[i] = s;
  }
  precise Real slop = pc_min(f.h1, f.h2) * PC_DEEPER_SLOP;
  pc_reduce(polygon, margin, slop);
  uint face = tag + f.id * 1024u;
  for (uint i = 0u; i < polygon.count; i++) {
    Vec3 x = pc_combine(f.e1, polygon.x[i], f.e2, polygon.y[i], f.c, PC_REAL(1.0));
    precise Real back = polygon.s[i] * PC_REAL(-0.5);
    uint corner = polygon.id[i];
    pc_push(m, pc_madd(x, fn, back), polygon.s[i], face + corner);
  }
  if (m.count == 0u && gap <= PC_REAL(0.0)) {  // they overlap where clipping found nothing: the deepest corner
    Real x = g1 > PC_REAL(0.0) ? -f.h1 : f.h1;
    Real y = g2 > PC_REAL(0.0) ? -f.h2 : f.h2;
    precise Real back = gap * PC_REAL(-0.5);
    pc_push(m, pc_madd(pc_combine(f.e1, x, f.e2, y, f.c, PC_REAL(1.0)), fn, back), gap, face);
  }
}
PC_FN void pc_box_face_points(BoxPair k, Vec3 xa, Vec3 xb, BoxAxis best, Real margin, PC_INOUT(NarrowManifold) m) {
  uint tag = best.axis * 8192u;
  if (best.axis < 3u) {
    m.normal = pc_scale(pc_axis(k.a, best.axis), pc_sign(pc_component(k.da, best.axis)));
    pc_box_faces(xa, k.a, k.ha, best.axis, m.normal, xb, k.b, k.hb, best.gap, margin, tag, m);
  } else {
    uint axis = best.axis - 3u;
    m.normal = pc_scale(pc_axis(k.b, axis), pc_sign(pc_component(k.db, axis)));
    pc_box_faces(xb, k.b, k.hb, axis, pc_negate(m.normal), xa, k.a, k.ha, best.gap, margin, tag, m);
  }
}

// Edge a_i over edge b_j. False where the shapes are apart and not these edges but their ends are closest.
PC_FN_LARGE bool pc_box_edges(BoxPair k, Vec3 xa, Vec3 xb, uint edges, Real gap, PC_INOUT(NarrowManifold) m) {
  uint i = edges / 3u;
  uint j = edges % 3u;
  Vec3 u = pc_axis(k.a, i);
  Vec3 v = pc_axis(k.b, j);
  Vec3 n = pc_unit_or_zero(pc_cross(u, v));
  if (pc_dot(n, k.d) < PC_REAL(0.0)) n = pc_negate(n);
  Vec3 pa = pc_add(xa, pc_to_world(k.a, pc_edge_middle(k.ha, i, pc_to_local(k.a, n))));
  Vec3 pb = pc_add(xb, pc_to_world(k.b, pc_edge_middle(k.hb, j, pc_to_local(k.b, pc_negate(n)))));
  Real ha = pc_component(k.ha, i);
  Real hb = pc_component(k.hb, j);
  Vec3 w = pc_sub(pb, pa);
  Real c = pc_dot(u, v);
  Real wu = pc_dot(u, w);
  Real wv = pc_dot(v, w);
  Vec3 x = pc_cross(u, v);
  precise Real numerator = wu - c * wv;
  Real s = pc_div(numerator, pc_dot(x, x));
  precise Real t = c * s - wv;
  if (gap > PC_REAL(0.0) && (pc_abs(s) > ha || pc_abs(t) > hb)) return false;
  Vec3 qa = pc_madd(pa, u, pc_clamp(s, -ha, ha));
  Vec3 qb = pc_madd(pb, v, pc_clamp(t, -hb, hb));
  precise Vec3 middle = (qa + qb) * PC_REAL(0.5);
  m.normal = n;
  pc_push(m, middle, gap, 0x10000u + edges);
  return true;
}

// Returns false, and no points that count, where only a general distance query gives the closest points: corners
// and edges apart.
PC_FN_LARGE bool pc_box_box(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(uint) hint,
                            PC_INOUT(NarrowManifold) m) {
  BoxPair k = pc_box_pair(a, b);
  Real smallest = pc_min(pc_smallest(a.size), pc_smallest(b.size));
  precise Real face_slop = smallest * PC_FACE_SLOP;
  precise Real edge_slop = smallest * PC_EDGE_SLOP;
  if (hint - 1u < 15u && pc_hint_separates(k, hint - 1u, margin, edge_slop)) return true;

  BoxAxis best_a = pc_best_face(k, 0u);
  if (best_a.gap > margin) {
    hint = 1u + best_a.axis;
    return true;
  }
  BoxAxis best_b = pc_best_face(k, 3u);
  if (best_b.gap > margin) {
    hint = 1u + best_b.axis;
    return true;
  }

  // the larger of the two faces, unless the other separates more
  bool prefer_b = pc_face_area(b.size, best_b.axis - 3u) > pc_face_area(a.size, best_a.axis);
  precise Real lead_a = best_a.gap - best_b.gap;
  precise Real lead_b = best_b.gap - best_a.gap;
  bool on_b = prefer_b ? !(lead_a > face_slop) : lead_b > face_slop;
  BoxAxis best = best_a;
  if (on_b) best = best_b;
  precise Real beat = best.gap + edge_slop;
  best.beat = beat;
  pc_try_edges(k, best);
  if (best.gap > margin) {
    hint = 1u + best.axis;
    return true;
  }

  if (best.axis >= 6u) return pc_box_edges(k, a.p, b.p, best.axis - 6u, best.gap, m);
  pc_box_face_points(k, a.p, b.p, best, margin, m);
  if (best.gap <= PC_REAL(0.0)) return true;
  // apart: does the corner nearest to the face lie over it?
  precise Real nearest = best.gap + edge_slop;
  bool held = false;
  for (uint i = 0u; i < m.count; i++) held = held || m.points[i].separation <= nearest;
  return held;
}
