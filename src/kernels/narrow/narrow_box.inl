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
  Vec3 d;
  Vec3 da;
  Vec3 db;  // centre of b from a: origin's axes, a's, b's
  Vec3 rx;
  Vec3 ry;
  Vec3 rz;  // b's axes in a's: r_i = (a_i . b_x, a_i . b_y, a_i . b_z)
  Vec3 ax;
  Vec3 ay;
  Vec3 az;  // their absolute values
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

// Separation = numerator / sqrt(squared)
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

// Axis 6 + 3 i + j is a_i x b_j; `beat`: what the next edge axis must exceed.
struct BoxAxis {
  Real gap;
  Real beat;
  uint axis;
};
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

// Incident face of one box against face `axis` of the reference one; fn is the outward normal of the latter.
PC_FN_LARGE void pc_box_faces(Vec3 xr, Axes reference, Vec3 hr, uint axis, Vec3 fn, Vec3 xi, Axes incident, Vec3 hi,
                              Real gap, Real margin, uint tag, PC_INOUT(NarrowManifold) m) {
  // incident face: the one that looks most against fn
  Vec3 look = pc_to_local(incident, fn);
  Vec3 steep = pc_abs3(look);
  uint f = pc_greatest_component(steep);
  bool up = pc_component(look, f) < PC_REAL(0.0);
  uint f1 = pc_next(f);
  uint f2 = pc_next(f1);
  uint r1 = pc_next(axis);
  uint r2 = pc_next(r1);
  Vec3 e1 = pc_axis(incident, f1);
  Vec3 e2 = pc_axis(incident, f2);
  Real h1 = pc_component(hi, f1);
  Real h2 = pc_component(hi, f2);
  Vec3 u = pc_axis(reference, r1);
  Vec3 v = pc_axis(reference, r2);
  Real hu = pc_component(hr, r1);
  Real hv = pc_component(hr, r2);
  Real lift = pc_component(hi, f);
  Vec3 centre = pc_madd(xi, pc_axis(incident, f), up ? lift : -lift);
  Vec3 c = pc_sub(centre, xr);

  NarrowPolygon polygon;
  polygon.count = 4u;
  polygon.x[0] = -h1;
  polygon.y[0] = -h2;
  polygon.id[0] = 3u * 32u + 0u;
  polygon.x[1] = h1;
  polygon.y[1] = -h2;
  polygon.id[1] = 0u * 32u + 1u;
  polygon.x[2] = h1;
  polygon.y[2] = h2;
  polygon.id[2] = 1u * 32u + 2u;
  polygon.x[3] = -h1;
  polygon.y[3] = h2;
  polygon.id[3] = 2u * 32u + 3u;

  // the reference face's sides in the incident face's coordinates; those that cut nothing are passed over
  Real u0 = pc_dot(c, u);
  Real ua = pc_dot(e1, u);
  Real ub = pc_dot(e2, u);
  Real v0 = pc_dot(c, v);
  Real va = pc_dot(e1, v);
  Real vb = pc_dot(e2, v);
  precise Real extent_u = pc_abs(ua) * h1 + pc_abs(ub) * h2;
  precise Real extent_v = pc_abs(va) * h1 + pc_abs(vb) * h2;
  precise Real slop_u = pc_min(hu, extent_u) * PC_CLIP_SLOP;
  precise Real slop_v = pc_min(hv, extent_v) * PC_CLIP_SLOP;
  precise Real over_u = u0 + extent_u - hu;
  precise Real under_u = extent_u - u0 - hu;
  precise Real over_v = v0 + extent_v - hv;
  precise Real under_v = extent_v - v0 - hv;
  precise Real cu = hu - u0;
  precise Real du = hu + u0;
  precise Real cv = hv - v0;
  precise Real dv = hv + v0;
  if (over_u > slop_u) pc_clip(polygon, ua, ub, cu, slop_u, 16u);
  if (under_u > slop_u) pc_clip(polygon, -ua, -ub, du, slop_u, 18u);
  if (over_v > slop_v) pc_clip(polygon, va, vb, cv, slop_v, 17u);
  if (under_v > slop_v) pc_clip(polygon, -va, -vb, dv, slop_v, 19u);

  Real g1 = pc_dot(e1, fn);
  Real g2 = pc_dot(e2, fn);
  precise Real g0 = pc_dot(c, fn) - pc_component(hr, axis);
  for (uint i = 0u; i < polygon.count; i++) {
    precise Real s = g0 + g1 * polygon.x[i] + g2 * polygon.y[i];
    polygon.s[i] = s;
  }
  precise Real slop = pc_min(h1, h2) * PC_DEEPER_SLOP;
  pc_reduce(polygon, margin, slop);
  uint turned = up ? 1u : 0u;
  uint face = tag + (f * 2u + turned) * 1024u;
  for (uint i = 0u; i < polygon.count; i++) {
    Vec3 x = pc_combine(e1, polygon.x[i], e2, polygon.y[i], centre, PC_REAL(1.0));
    precise Real back = polygon.s[i] * PC_REAL(-0.5);
    uint corner = polygon.id[i];
    pc_push(m, pc_madd(x, fn, back), polygon.s[i], face + corner);
  }
  if (m.count == 0u && gap <= PC_REAL(0.0)) {  // they overlap where clipping found nothing: the deepest corner
    Real x = g1 > PC_REAL(0.0) ? -h1 : h1;
    Real y = g2 > PC_REAL(0.0) ? -h2 : h2;
    precise Real back = gap * PC_REAL(-0.5);
    pc_push(m, pc_madd(pc_combine(e1, x, e2, y, centre, PC_REAL(1.0)), fn, back), gap, face);
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

  Real gap_a = pc_face_gap(k, 0u);
  uint axis_a = 0u;
  Real g1 = pc_face_gap(k, 1u);
  if (g1 > gap_a) {
    gap_a = g1;
    axis_a = 1u;
  }
  Real g2 = pc_face_gap(k, 2u);
  if (g2 > gap_a) {
    gap_a = g2;
    axis_a = 2u;
  }
  if (gap_a > margin) {
    hint = 1u + axis_a;
    return true;
  }
  Real gap_b = pc_face_gap(k, 3u);
  uint axis_b = 0u;
  Real g4 = pc_face_gap(k, 4u);
  if (g4 > gap_b) {
    gap_b = g4;
    axis_b = 1u;
  }
  Real g5 = pc_face_gap(k, 5u);
  if (g5 > gap_b) {
    gap_b = g5;
    axis_b = 2u;
  }
  if (gap_b > margin) {
    hint = 4u + axis_b;
    return true;
  }

  // the larger of the two faces, unless the other separates more
  bool prefer_b = pc_face_area(b.size, axis_b) > pc_face_area(a.size, axis_a);
  precise Real lead_a = gap_a - gap_b;
  precise Real lead_b = gap_b - gap_a;
  bool on_b = prefer_b ? !(lead_a > face_slop) : lead_b > face_slop;
  BoxAxis best;
  best.gap = on_b ? gap_b : gap_a;
  best.axis = on_b ? 3u + axis_b : axis_a;
  precise Real beat = best.gap + edge_slop;
  best.beat = beat;
  pc_try_edge(k, 0u, 0u, best);
  pc_try_edge(k, 0u, 1u, best);
  pc_try_edge(k, 0u, 2u, best);
  pc_try_edge(k, 1u, 0u, best);
  pc_try_edge(k, 1u, 1u, best);
  pc_try_edge(k, 1u, 2u, best);
  pc_try_edge(k, 2u, 0u, best);
  pc_try_edge(k, 2u, 1u, best);
  pc_try_edge(k, 2u, 2u, best);
  if (best.gap > margin) {
    hint = 1u + best.axis;
    return true;
  }

  if (best.axis >= 6u) return pc_box_edges(k, a.p, b.p, best.axis - 6u, best.gap, m);
  if (best.axis < 3u) {
    Vec3 n = pc_scale(pc_axis(k.a, best.axis), pc_sign(pc_component(k.da, best.axis)));
    m.normal = n;
    pc_box_faces(a.p, k.a, a.size, best.axis, n, b.p, k.b, b.size, best.gap, margin, best.axis * 8192u, m);
  } else {
    Vec3 n = pc_scale(pc_axis(k.b, best.axis - 3u), pc_sign(pc_component(k.db, best.axis - 3u)));
    m.normal = n;
    pc_box_faces(b.p, k.b, b.size, best.axis - 3u, pc_negate(n), a.p, k.a, a.size, best.gap, margin, best.axis * 8192u,
                 m);
  }
  if (best.gap <= PC_REAL(0.0)) return true;
  // apart: does the corner nearest to the face lie over it?
  precise Real nearest = best.gap + edge_slop;
  bool held = false;
  for (uint i = 0u; i < m.count; i++) held = held || m.points[i].separation <= nearest;
  return held;
}
