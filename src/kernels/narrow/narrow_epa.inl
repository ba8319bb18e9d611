// Penetration of two cores (G. van den Bergen, 2001): a polytope inside D grows at its face nearest to the
// origin until that face lies on D's surface. Distances are signed, so the first tetrahedron need not hold
// the origin, and shapes a rounding error apart are as good as touching ones.

#define PC_HULL_VERTICES 64u
#define PC_HULL_FACES 128u
struct Hull {
  uint vertices; uint faces; Vec3 w[64]; Vec3 a[64];
  uint i[128]; uint j[128]; uint k[128]; Vec3 n[128]; Real h[128]; Real noise[128];
  Vec3 inner; Real rounding; Real size;  // a point inside; rounding error of a vertex; of D
};
struct Penetration { Vec3 n; Real h; Vec3 a; };  // h(n) is least along n; a: the point of A there

PC_FN void pc_hull_vertex(PC_INOUT(Hull) hull, Support s) { hull.w[hull.vertices] = s.w; hull.a[hull.vertices] = s.a; hull.vertices = hull.vertices + 1u; }

// Face i j k, counter-clockwise from outside. A vertex less than `noise` beyond its plane does not see it: the
// rounding of the normal of a narrow triangle, carried over the whole polytope. A face without a normal,
// or turned inside out by rounding (the caps of cylinders are full of points in one plane), is never chosen.
PC_FN_LARGE void pc_hull_face(PC_INOUT(Hull) hull, uint i, uint j, uint k) {
  uint f = hull.faces; hull.faces = f + 1u;
  hull.i[f] = i; hull.j[f] = j; hull.k[f] = k;
  hull.n[f] = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0)); hull.h[f] = PC_REAL(1e30); hull.noise[f] = PC_REAL(0.0);
  Vec3 ij = pc_sub(hull.w[j], hull.w[i]); Vec3 ik = pc_sub(hull.w[k], hull.w[i]);
  Vec3 n = pc_cross(ij, ik); Real length = pc_length(n); Real longest = pc_sqrt(pc_max(pc_dot(ij, ij), pc_dot(ik, ik)));
  precise Real sliver = longest * hull.rounding;
  if (!(length > sliver)) return;
  Vec3 u = pc_scale(n, pc_div(PC_REAL(1.0), length)); Real h = pc_dot(u, hull.w[i]); Real inside = pc_dot(u, hull.inner);
  if (!(inside < h)) return;
  precise Real spread = hull.size * longest;
  precise Real noise = hull.rounding * (PC_REAL(1.0) + pc_div(spread, length));
  hull.n[f] = u; hull.h[f] = h; hull.noise[f] = noise;
}
PC_FN void pc_hull_seed_face(PC_INOUT(Hull) hull, uint i, uint j, uint k) {
  Vec3 n = pc_cross(pc_sub(hull.w[j], hull.w[i]), pc_sub(hull.w[k], hull.w[i]));
  if (pc_dot(n, pc_sub(hull.inner, hull.w[i])) > PC_REAL(0.0)) pc_hull_face(hull, i, k, j);
  else pc_hull_face(hull, i, j, k);
}

// Of the supports along d and against it, the one farther from the plane through `at`.
PC_FN_LARGE Support pc_far_support(Core a, Core b, Vec3 d, Vec3 at) {
  Support s = pc_support(a, b, d); Support t = pc_support(a, b, pc_negate(d));
  bool first = pc_abs(pc_dot(d, pc_sub(s.w, at))) >= pc_abs(pc_dot(d, pc_sub(t.w, at)));
  if (first) return s;
  return t;
}

PC_FN_LARGE void pc_hull_seed(PC_INOUT(Hull) hull, Core a, Core b, Vec3 d) {
  hull.vertices = 0u; hull.faces = 0u;
  pc_hull_vertex(hull, pc_support(a, b, d));
  pc_hull_vertex(hull, pc_far_support(a, b, d, hull.w[0]));
  Vec3 e = pc_unit_or_zero(pc_sub(hull.w[1], hull.w[0]));
  pc_hull_vertex(hull, pc_far_support(a, b, pc_perpendicular(e), hull.w[0]));
  Vec3 n = pc_unit_or_zero(pc_cross(pc_sub(hull.w[1], hull.w[0]), pc_sub(hull.w[2], hull.w[0])));
  pc_hull_vertex(hull, pc_far_support(a, b, n, hull.w[0]));
  precise Vec3 inner = (hull.w[0] + hull.w[1] + hull.w[2] + hull.w[3]) * PC_REAL(0.25);
  precise Real size = a.reach + b.reach; precise Real rounding = size * PC_EPA_ROUNDING;
  hull.inner = inner; hull.size = size; hull.rounding = rounding;
  pc_hull_seed_face(hull, 0u, 1u, 2u); pc_hull_seed_face(hull, 0u, 1u, 3u); pc_hull_seed_face(hull, 0u, 2u, 3u); pc_hull_seed_face(hull, 1u, 2u, 3u);
}

// Replaces the faces that the last vertex sees, `seen` among them, by a cone from it over their rim. False when
// there is no room.
PC_FN_LARGE bool pc_hull_grow(PC_INOUT(Hull) hull, uint seen) {
  uint apex = hull.vertices - 1u; Vec3 w = hull.w[apex];
  uint from[96]; uint to[96]; uint edges = 0u; uint kept = 0u;
  for (uint f = 0u; f < hull.faces; f++) {
    precise Real beyond = pc_dot(hull.n[f], w) - hull.h[f];
    if (f == seen || beyond > hull.noise[f]) {
      for (uint c = 0u; c < 3u; c++) {
        uint p = c == 0u ? hull.i[f] : (c == 1u ? hull.j[f] : hull.k[f]); uint q = c == 0u ? hull.j[f] : (c == 1u ? hull.k[f] : hull.i[f]);
        uint found = edges;
        for (uint e = 0u; e < edges; e++) { if (from[e] == q && to[e] == p) found = e; }
        if (found < edges) { edges = edges - 1u; from[found] = from[edges]; to[found] = to[edges]; }
        else { if (edges == 96u) return false; from[edges] = p; to[edges] = q; edges = edges + 1u; }
      }
    } else {
      hull.i[kept] = hull.i[f]; hull.j[kept] = hull.j[f]; hull.k[kept] = hull.k[f]; hull.n[kept] = hull.n[f]; hull.h[kept] = hull.h[f]; hull.noise[kept] = hull.noise[f];
      kept = kept + 1u;
    }
  }
  hull.faces = kept;
  if (edges < 3u || kept + edges > PC_HULL_FACES) return false;
  for (uint e = 0u; e < edges; e++) pc_hull_face(hull, from[e], to[e], apex);
  return true;
}

// Point of A under the origin's foot on a face.
PC_FN Vec3 pc_hull_witness(Hull hull, uint f) {
  uint i = hull.i[f]; uint j = hull.j[f]; uint k = hull.k[f];
  Vec3 foot = pc_scale(hull.n[f], hull.h[f]);
  Nearest n = pc_nearest_on_triangle(pc_sub(hull.w[i], foot), pc_sub(hull.w[j], foot), pc_sub(hull.w[k], foot));
  return pc_combine(hull.a[i], n.l0, hull.a[j], n.l1, hull.a[k], n.l2);
}

PC_FN_LARGE Penetration pc_penetration(Core a, Core b, Vec3 start) {
  precise Real size = a.reach + b.reach; precise Real tolerance = size * PC_EPA_GAP;
  Hull hull; pc_hull_seed(hull, a, b, start);
  Penetration o; o.n = start; o.h = PC_REAL(1e30); o.a = hull.a[0];
  for (uint round = 0u; round < PC_HULL_VERTICES; round++) {
    uint f = 0u;
    for (uint i = 1u; i < hull.faces; i++) { if (hull.h[i] < hull.h[f]) f = i; }
    Vec3 n = hull.n[f]; Support s = pc_support(a, b, n); Real h = pc_dot(n, s.w);
    precise Real gap = h - hull.h[f];
    if (h < o.h && hull.h[f] < PC_REAL(1e29)) { o.n = n; o.h = h; o.a = pc_hull_witness(hull, f); }
    if (!(gap > tolerance) || hull.vertices == PC_HULL_VERTICES) break;
    pc_hull_vertex(hull, s);
    if (!pc_hull_grow(hull, f)) break;
  }
  return o;
}
