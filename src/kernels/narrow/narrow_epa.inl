// Penetration of two cores (G. van den Bergen, 2001): a polytope inside D grows at its face nearest to the
// origin until that face lies on D's surface. Distances are signed, so the first tetrahedron need not hold
// the origin, and shapes a rounding error apart are as good as touching ones.

#define PC_POLYTOPE_VERTICES 64u
#define PC_POLYTOPE_FACES 128u
struct Polytope {
  uint vertices;
  uint faces;
  Vec3 w[64];
  Vec3 a[64];
  uint i[128];
  uint j[128];
  uint k[128];
  Vec3 n[128];
  Real h[128];
  Real noise[128];
  Vec3 inner;     // a point inside
  Real rounding;  // error of a vertex
  Real size;      // of D
};
// h(n) is least along n; a: the point of A there.
struct Penetration {
  Vec3 n;
  Real h;
  Vec3 a;
};

PC_FN void pc_polytope_vertex(PC_INOUT(Polytope) polytope, Support s) {
  polytope.w[polytope.vertices] = s.w;
  polytope.a[polytope.vertices] = s.a;
  polytope.vertices = polytope.vertices + 1u;
}

// Face i j k, counter-clockwise from outside. A vertex less than `noise` beyond its plane does not see it: the
// rounding of the normal of a narrow triangle, carried over the whole polytope. A face without a normal,
// or turned inside out by rounding (the caps of cylinders are full of points in one plane), is never chosen.
PC_FN_LARGE void pc_polytope_face(PC_INOUT(Polytope) polytope, uint i, uint j, uint k) {
  uint f = polytope.faces;
  polytope.faces = f + 1u;
  polytope.i[f] = i;
  polytope.j[f] = j;
  polytope.k[f] = k;
  polytope.n[f] = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0));
  polytope.h[f] = PC_FAR;
  polytope.noise[f] = PC_REAL(0.0);
  Vec3 ij = pc_sub(polytope.w[j], polytope.w[i]);
  Vec3 ik = pc_sub(polytope.w[k], polytope.w[i]);
  Vec3 n = pc_cross(ij, ik);
  Real length = pc_length(n);
  Real longest = pc_sqrt(pc_max(pc_dot(ij, ij), pc_dot(ik, ik)));
  precise Real sliver = longest * polytope.rounding;
  if (!(length > sliver)) return;
  Vec3 u = pc_scale(n, pc_div(PC_REAL(1.0), length));
  Real h = pc_dot(u, polytope.w[i]);
  Real inside = pc_dot(u, polytope.inner);
  if (!(inside < h)) return;
  precise Real spread = polytope.size * longest;
  precise Real noise = polytope.rounding * (PC_REAL(1.0) + pc_div(spread, length));
  polytope.n[f] = u;
  polytope.h[f] = h;
  polytope.noise[f] = noise;
}
PC_FN void pc_polytope_seed_face(PC_INOUT(Polytope) polytope, uint i, uint j, uint k) {
  Vec3 n = pc_cross(pc_sub(polytope.w[j], polytope.w[i]), pc_sub(polytope.w[k], polytope.w[i]));
  if (pc_dot(n, pc_sub(polytope.inner, polytope.w[i])) > PC_REAL(0.0))
    pc_polytope_face(polytope, i, k, j);
  else
    pc_polytope_face(polytope, i, j, k);
}

// Of the supports along d and against it, the one farther from the plane through `at`.
PC_FN_LARGE Support pc_far_support(Core a, Core b, Vec3 d, Vec3 at) {
  Support s = pc_support(a, b, d);
  Support t = pc_support(a, b, pc_negate(d));
  bool first = pc_abs(pc_dot(d, pc_sub(s.w, at))) >= pc_abs(pc_dot(d, pc_sub(t.w, at)));
  if (first) return s;
  return t;
}

PC_FN_LARGE void pc_polytope_seed(PC_INOUT(Polytope) polytope, Core a, Core b, Vec3 d) {
  polytope.vertices = 0u;
  polytope.faces = 0u;
  pc_polytope_vertex(polytope, pc_support(a, b, d));
  pc_polytope_vertex(polytope, pc_far_support(a, b, d, polytope.w[0]));
  Vec3 e = pc_unit_or_zero(pc_sub(polytope.w[1], polytope.w[0]));
  pc_polytope_vertex(polytope, pc_far_support(a, b, pc_perpendicular(e), polytope.w[0]));
  Vec3 n = pc_unit_or_zero(pc_cross(pc_sub(polytope.w[1], polytope.w[0]), pc_sub(polytope.w[2], polytope.w[0])));
  pc_polytope_vertex(polytope, pc_far_support(a, b, n, polytope.w[0]));
  precise Vec3 inner = (polytope.w[0] + polytope.w[1] + polytope.w[2] + polytope.w[3]) * PC_REAL(0.5) * PC_REAL(0.5);
  precise Real size = a.reach + b.reach;
  precise Real rounding = size * PC_EPA_ROUNDING;
  polytope.inner = inner;
  polytope.size = size;
  polytope.rounding = rounding;
  pc_polytope_seed_face(polytope, 0u, 1u, 2u);
  pc_polytope_seed_face(polytope, 0u, 1u, 3u);
  pc_polytope_seed_face(polytope, 0u, 2u, 3u);
  pc_polytope_seed_face(polytope, 1u, 2u, 3u);
}

// Replaces the faces that the last vertex sees, `seen` among them, by a cone from it over their rim. False when
// there is no room.
PC_FN_LARGE bool pc_polytope_grow(PC_INOUT(Polytope) polytope, uint seen) {
  uint apex = polytope.vertices - 1u;
  Vec3 w = polytope.w[apex];
  uint from[96];
  uint to[96];
  uint edges = 0u;
  uint kept = 0u;
  for (uint f = 0u; f < polytope.faces; f++) {
    precise Real beyond = pc_dot(polytope.n[f], w) - polytope.h[f];
    if (f == seen || beyond > polytope.noise[f]) {
      for (uint c = 0u; c < 3u; c++) {
        uint p = c == 0u ? polytope.i[f] : (c == 1u ? polytope.j[f] : polytope.k[f]);
        uint q = c == 0u ? polytope.j[f] : (c == 1u ? polytope.k[f] : polytope.i[f]);
        uint found = edges;
        for (uint e = 0u; e < edges; e++) {
          if (from[e] == q && to[e] == p) found = e;
        }
        if (found < edges) {
          edges = edges - 1u;
          from[found] = from[edges];
          to[found] = to[edges];
        } else {
          if (edges == 96u) return false;
          from[edges] = p;
          to[edges] = q;
          edges = edges + 1u;
        }
      }
    } else {
      polytope.i[kept] = polytope.i[f];
      polytope.j[kept] = polytope.j[f];
      polytope.k[kept] = polytope.k[f];
      polytope.n[kept] = polytope.n[f];
      polytope.h[kept] = polytope.h[f];
      polytope.noise[kept] = polytope.noise[f];
      kept = kept + 1u;
    }
  }
  polytope.faces = kept;
  if (edges < 3u || kept + edges > PC_POLYTOPE_FACES) return false;
  for (uint e = 0u; e < edges; e++) pc_polytope_face(polytope, from[e], to[e], apex);
  return true;
}

// Point of A under the origin's foot on a face.
PC_FN Vec3 pc_polytope_witness(Polytope polytope, uint f) {
  uint i = polytope.i[f];
  uint j = polytope.j[f];
  uint k = polytope.k[f];
  Vec3 foot = pc_scale(polytope.n[f], polytope.h[f]);
  Nearest n =
      pc_nearest_on_triangle(pc_sub(polytope.w[i], foot), pc_sub(polytope.w[j], foot), pc_sub(polytope.w[k], foot));
  return pc_combine(polytope.a[i], n.l0, polytope.a[j], n.l1, polytope.a[k], n.l2);
}

PC_FN_LARGE Penetration pc_penetration(Core a, Core b, Vec3 start) {
  precise Real size = a.reach + b.reach;
  precise Real tolerance = size * PC_EPA_GAP;
  Polytope polytope;
  pc_polytope_seed(polytope, a, b, start);
  Penetration o;
  o.n = start;
  o.h = PC_FAR;
  o.a = polytope.a[0];
  for (uint round = 0u; round < PC_POLYTOPE_VERTICES; round++) {
    uint f = 0u;
    for (uint i = 1u; i < polytope.faces; i++) {
      if (polytope.h[i] < polytope.h[f]) f = i;
    }
    Vec3 n = polytope.n[f];
    Support s = pc_support(a, b, n);
    Real h = pc_dot(n, s.w);
    precise Real gap = h - polytope.h[f];
    if (h < o.h && polytope.h[f] < PC_FAR) {
      o.n = n;
      o.h = h;
      o.a = pc_polytope_witness(polytope, f);
    }
    if (!(gap > tolerance) || polytope.vertices == PC_POLYTOPE_VERTICES) break;
    pc_polytope_vertex(polytope, s);
    if (!pc_polytope_grow(polytope, f)) break;
  }
  return o;
}
