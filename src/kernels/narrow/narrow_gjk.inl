// Distance of two cores (E. Gilbert, D. Johnson, S. Keerthi, 1988): the point v of D nearest to the origin, by
// simplices of support points. Stops when the gap between |v| and the lower bound v . w / |v| is rounding.

// v = sum l w.
struct Simplex {
  uint count;
  Vec3 w[4];
  Vec3 a[4];
  Real l[4];
  Vec3 v;
};
// `separated`: farther than asked; `touching`: use EPA.
struct Distance {
  bool separated;
  bool touching;
  Vec3 v;
  Vec3 a;
};

// The simplex of one point (in place: glslangValidator takes memory without end where a function returns it).
PC_FN void pc_one_point(PC_INOUT(Simplex) s, Support p) {
  s.count = 1u;
  s.v = p.w;
  for (uint i = 0u; i < 4u; i++) {
    s.w[i] = p.w;
    s.a[i] = p.a;
    s.l[i] = PC_REAL(1.0);
  }
}
PC_FN void pc_simplex_point(PC_INOUT(Simplex) s, uint i, Real l) {
  s.w[s.count] = s.w[i];
  s.a[s.count] = s.a[i];
  s.l[s.count] = l;
  s.count = s.count + 1u;
}

struct Nearest {
  Vec3 v;
  Real l0;
  Real l1;
  Real l2;
};
PC_FN Nearest pc_nearest(Vec3 v, Real l0, Real l1, Real l2) {
  Nearest n;
  n.v = v;
  n.l0 = l0;
  n.l1 = l1;
  n.l2 = l2;
  return n;
}

PC_FN Nearest pc_nearest_on_segment(Vec3 a, Vec3 b) {
  Vec3 e = pc_sub(b, a);
  Real squared = pc_dot(e, e);
  Real t = pc_has_length(squared) ? pc_clamp(pc_div(-pc_dot(a, e), squared), PC_REAL(0.0), PC_REAL(1.0)) : PC_REAL(0.0);
  precise Real rest = PC_REAL(1.0) - t;
  return pc_nearest(t >= PC_REAL(1.0) ? b : pc_madd(a, e, t), rest, t, PC_REAL(0.0));
}

// Point of the triangle nearest to the origin by its Voronoi regions (C. Ericson, Real-Time Collision
// Detection, 5.1.5). Over the face, v comes from the normal: its direction keeps its digits when it is short.
PC_FN_LARGE Nearest pc_nearest_on_triangle(Vec3 a, Vec3 b, Vec3 c) {
  Vec3 ab = pc_sub(b, a);
  Vec3 ac = pc_sub(c, a);
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  Real d1 = -pc_dot(ab, a);
  Real d2 = -pc_dot(ac, a);
  if (d1 <= zero && d2 <= zero) return pc_nearest(a, one, zero, zero);
  Real d3 = -pc_dot(ab, b);
  Real d4 = -pc_dot(ac, b);
  if (d3 >= zero && d4 <= d3) return pc_nearest(b, zero, one, zero);
  Real d5 = -pc_dot(ab, c);
  Real d6 = -pc_dot(ac, c);
  if (d6 >= zero && d5 <= d6) return pc_nearest(c, zero, zero, one);
  precise Real vc = d1 * d4 - d3 * d2;
  precise Real vb = d5 * d2 - d1 * d6;
  precise Real va = d3 * d6 - d5 * d4;
  if (vc <= zero && d1 >= zero && d3 <= zero) return pc_nearest_on_segment(a, b);
  if (vb <= zero && d2 >= zero && d6 <= zero) {
    Nearest n = pc_nearest_on_segment(a, c);
    return pc_nearest(n.v, n.l0, zero, n.l1);
  }
  precise Real e1 = d4 - d3;
  precise Real e2 = d5 - d6;
  if (va <= zero && e1 >= zero && e2 >= zero) {
    Nearest n = pc_nearest_on_segment(b, c);
    return pc_nearest(n.v, zero, n.l0, n.l1);
  }
  Vec3 normal = pc_cross(ab, ac);
  Real squared = pc_dot(normal, normal);
  precise Real sum = va + vb + vc;
  precise Real sliver = pc_dot(ab, ab) * pc_dot(ac, ac) * PC_GJK_SLIVER;
  if (!(squared > sliver) || !(sum > zero)) {  // no normal to speak of: the nearest of its sides
    Nearest n1 = pc_nearest_on_segment(a, b);
    Nearest n2 = pc_nearest_on_segment(a, c);
    Nearest n3 = pc_nearest_on_segment(b, c);
    Real s1 = pc_dot(n1.v, n1.v);
    Real s2 = pc_dot(n2.v, n2.v);
    Real s3 = pc_dot(n3.v, n3.v);
    if (s1 <= s2 && s1 <= s3) return n1;
    if (s2 <= s3) return pc_nearest(n2.v, n2.l0, zero, n2.l1);
    return pc_nearest(n3.v, zero, n3.l0, n3.l1);
  }
  Real i = pc_div(one, sum);
  precise Real lb = vb * i;
  precise Real lc = vc * i;
  precise Real la = one - lb - lc;
  return pc_nearest(pc_scale(normal, pc_div(pc_dot(normal, a), squared)), la, lb, lc);
}

// Keeps of the simplex what its nearest point needs. Returns false when a tetrahedron holds the origin.
PC_FN_LARGE bool pc_reduce_simplex(PC_INOUT(Simplex) s) {
  if (s.count == 1u) {
    s.v = s.w[0];
    s.l[0] = PC_REAL(1.0);
    return true;
  }
  uint i0 = 0u;
  uint i1 = 1u;
  uint i2 = 2u;
  Nearest n;
  if (s.count == 2u) {
    n = pc_nearest_on_segment(s.w[0], s.w[1]);
  } else if (s.count == 3u) {
    n = pc_nearest_on_triangle(s.w[0], s.w[1], s.w[2]);
  } else {
    bool outside = false;
    Real best = PC_REAL(0.0);
    for (uint f = 0u; f < 4u; f++) {  // the face without vertex f
      uint j0 = f == 0u ? 1u : 0u;
      uint j1 = f <= 1u ? 2u : 1u;
      uint j2 = f <= 2u ? 3u : 2u;
      Vec3 normal = pc_cross(pc_sub(s.w[j1], s.w[j0]), pc_sub(s.w[j2], s.w[j0]));
      Real origin = -pc_dot(normal, s.w[j0]);
      Real vertex = pc_dot(normal, pc_sub(s.w[f], s.w[j0]));
      bool beyond =
          vertex > PC_REAL(0.0) ? origin <= PC_REAL(0.0) : (vertex < PC_REAL(0.0) ? origin >= PC_REAL(0.0) : true);
      if (beyond) {
        Nearest t = pc_nearest_on_triangle(s.w[j0], s.w[j1], s.w[j2]);
        Real squared = pc_dot(t.v, t.v);
        if (!outside || squared < best) {
          best = squared;
          n = t;
          i0 = j0;
          i1 = j1;
          i2 = j2;
          outside = true;
        }
      }
    }
    if (!outside) return false;
  }
  uint vertices = s.count;
  s.count = 0u;
  s.v = n.v;
  if (n.l0 > PC_REAL(0.0)) pc_simplex_point(s, i0, n.l0);
  if (n.l1 > PC_REAL(0.0)) pc_simplex_point(s, i1, n.l1);
  if (vertices > 2u && n.l2 > PC_REAL(0.0)) pc_simplex_point(s, i2, n.l2);
  return true;
}

// `start` is any direction; farther than `farthest` the search ends early; nearer than `touch` is for EPA.
PC_FN_LARGE Distance pc_distance(Core a, Core b, Vec3 start, Real farthest, Real touch) {
  Distance o;
  o.separated = false;
  o.touching = false;
  Simplex s;
  pc_one_point(s, pc_support(a, b, start));
  precise Real touch_squared = touch * touch;
  Simplex best = s;
  uint starts = 0u;
  for (uint k = 0u; k < 40u; k++) {
    Real squared = pc_dot(s.v, s.v);
    if (!(squared > touch_squared)) {
      o.touching = true;
      break;
    }
    Support p = pc_support(a, b, pc_negate(s.v));
    Real bound = pc_dot(s.v, p.w);
    Real length = pc_sqrt(squared);
    precise Real far = length * farthest;
    if (bound > far) {
      o.separated = true;
      break;
    }
    precise Real gap = squared - bound;
    precise Real least = squared * PC_GJK_GAP;
    if (gap <= least) break;
    bool known = false;
    for (uint i = 0u; i < s.count; i++) known = known || (s.w[i].x == p.w.x && s.w[i].y == p.w.y && s.w[i].z == p.w.z);
    if (known) break;
    s.w[s.count] = p.w;
    s.a[s.count] = p.a;
    s.count = s.count + 1u;
    if (!pc_reduce_simplex(s)) {  // holds the origin, unless the bound says that it cannot: then it is flat
      o.touching = !(bound > least);
      s = best;
      break;
    }
    if (pc_dot(s.v, s.v) < pc_dot(best.v, best.v)) best = s;
    if (!(pc_dot(s.v, s.v) < squared)) {  // rounding: the last one was as good; a narrow simplex is given up
      precise Real good = squared * PC_CORE_TOUCH;
      if (gap <= good || starts == 2u) break;
      starts = starts + 1u;
      pc_one_point(s, p);
    }
  }
  if (pc_dot(best.v, best.v) < pc_dot(s.v, s.v)) s = best;
  o.v = s.v;
  o.a = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0));
  for (uint i = 0u; i < s.count; i++) o.a = pc_madd(o.a, s.a[i], s.l[i]);
  return o;
}
