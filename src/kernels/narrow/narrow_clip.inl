// Clipping a convex polygon in the plane, and choosing four of its points.
//
// A vertex carries the numbers of the edge that enters and the edge that leaves it, in * 32 + out: edges 0 to
// 15 belong to the incident polygon, 16 on to the clipping one. That pair is its feature: it stays while the
// shapes move a little.

struct NarrowPolygon {
  uint count;
  Real x[32];
  Real y[32];
  Real s[32];
  uint id[32];
};

PC_FN void pc_put_corner(PC_INOUT(NarrowPolygon) polygon, uint i, Real x, Real y) {
  polygon.x[i] = x;
  polygon.y[i] = y;
}
// Of half sides h1 and h2.
PC_FN void pc_rectangle(PC_INOUT(NarrowPolygon) polygon, Real h1, Real h2) {
  polygon.count = 4u;
  pc_put_corner(polygon, 0u, -h1, -h2);
  pc_put_corner(polygon, 1u, h1, -h2);
  pc_put_corner(polygon, 2u, h1, h2);
  pc_put_corner(polygon, 3u, -h1, h2);
}
// Edge i leaves vertex i.
PC_FN void pc_number_edges(PC_INOUT(NarrowPolygon) polygon, uint count) {
  for (uint i = 0u; i < count; i++) polygon.id[i] = ((i == 0u ? count - 1u : i - 1u) << 5u) | i;
}

// What is left of the polygon on the side a x + b y <= c; outside by less than `slop` counts as inside.
PC_FN_LARGE void pc_clip(PC_INOUT(NarrowPolygon) polygon, Real a, Real b, Real c, Real slop, uint edge) {
  Real off[32];
  bool any = false;
  for (uint i = 0u; i < polygon.count; i++) {
    precise Real beyond = a * polygon.x[i] + b * polygon.y[i] - c;
    off[i] = beyond;
    any = any || beyond > slop;
  }
  if (!any) return;
  NarrowPolygon rest;
  rest.count = 0u;
  for (uint i = 0u; i < polygon.count; i++) {
    uint j = i + 1u == polygon.count ? 0u : i + 1u;
    bool inside_i = off[i] <= slop;
    bool inside_j = off[j] <= slop;
    if (inside_i != inside_j && rest.count < 32u) {
      precise Real span = off[i] - off[j];
      Real t = pc_clamp(pc_div(off[i], span), PC_REAL(0.0), PC_REAL(1.0));
      precise Real x = polygon.x[i] + (polygon.x[j] - polygon.x[i]) * t;
      precise Real y = polygon.y[i] + (polygon.y[j] - polygon.y[i]) * t;
      uint cut = polygon.id[i] & 31u;
      rest.x[rest.count] = x;
      rest.y[rest.count] = y;
      rest.id[rest.count] = inside_i ? (cut << 5u) | edge : (edge << 5u) | cut;
      rest.count = rest.count + 1u;
    }
    if (inside_j && rest.count < 32u) {
      rest.x[rest.count] = polygon.x[j];
      rest.y[rest.count] = polygon.y[j];
      rest.id[rest.count] = polygon.id[j];
      rest.count = rest.count + 1u;
    }
  }
  polygon.count = rest.count;
  for (uint i = 0u; i < rest.count; i++) {
    polygon.x[i] = rest.x[i];
    polygon.y[i] = rest.y[i];
    polygon.id[i] = rest.id[i];
  }
}

PC_FN void pc_keep(PC_INOUT(NarrowPolygon) polygon, uint to, uint from) {
  polygon.x[to] = polygon.x[from];
  polygon.y[to] = polygon.y[from];
  polygon.s[to] = polygon.s[from];
  polygon.id[to] = polygon.id[from];
}

// Twice the area of the triangle a b c, signed.
struct Corner {
  Real x;
  Real y;
};
PC_FN Corner pc_corner(PC_INOUT(NarrowPolygon) polygon, uint i) {
  Corner c;
  c.x = polygon.x[i];
  c.y = polygon.y[i];
  return c;
}
PC_FN Real pc_corner_area(Corner a, Corner b, Corner c) {
  precise Real r = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  return r;
}

PC_FN void pc_drop_beyond(PC_INOUT(NarrowPolygon) polygon, Real margin) {
  uint count = 0u;
  for (uint i = 0u; i < polygon.count; i++) {
    if (polygon.s[i] <= margin) {
      pc_keep(polygon, count, i);
      count = count + 1u;
    }
  }
  polygon.count = count;
}
PC_FN uint pc_deepest(PC_INOUT(NarrowPolygon) polygon, Real slop) {
  uint a = 0u;
  for (uint i = 1u; i < polygon.count; i++) {
    precise Real s = polygon.s[i] + slop;
    if (s < polygon.s[a]) a = i;
  }
  return a;
}
PC_FN uint pc_farthest(PC_INOUT(NarrowPolygon) polygon, uint a) {
  Corner at_a = pc_corner(polygon, a);
  uint b = a;
  Real best = PC_REAL(0.0);
  for (uint i = 0u; i < polygon.count; i++) {
    precise Real dx = polygon.x[i] - at_a.x;
    precise Real dy = polygon.y[i] - at_a.y;
    precise Real far = dx * dx + dy * dy;
    precise Real least = best * PC_WIDER_SLOP;
    if (far > least) {
      best = far;
      b = i;
    }
  }
  return b;
}
// `turn`: the triangle is counter-clockwise.
PC_FN uint pc_widest(PC_INOUT(NarrowPolygon) polygon, uint a, uint b, PC_INOUT(bool) turn) {
  Corner at_a = pc_corner(polygon, a);
  Corner at_b = pc_corner(polygon, b);
  uint c = a;
  Real best = PC_REAL(0.0);
  for (uint i = 0u; i < polygon.count; i++) {
    Real area = pc_corner_area(at_a, at_b, pc_corner(polygon, i));
    precise Real least = best * PC_WIDER_SLOP;
    if (pc_abs(area) > least) {
      best = pc_abs(area);
      c = i;
      turn = area > PC_REAL(0.0);
    }
  }
  return c;
}
// Of the largest triangle beyond any side of a, b, c.
PC_FN uint pc_fourth(PC_INOUT(NarrowPolygon) polygon, uint a, uint b, uint c, bool turn) {
  Corner at_a = pc_corner(polygon, a);
  Corner at_b = pc_corner(polygon, b);
  Corner at_c = pc_corner(polygon, c);
  uint d = a;
  Real best = PC_REAL(0.0);
  for (uint i = 0u; i < polygon.count; i++) {
    Corner p = pc_corner(polygon, i);
    Real ab = pc_corner_area(at_a, at_b, p);
    Real bc = pc_corner_area(at_b, at_c, p);
    Real ca = pc_corner_area(at_c, at_a, p);
    Real out_ab = turn ? -ab : ab;
    Real out_bc = turn ? -bc : bc;
    Real out_ca = turn ? -ca : ca;
    Real area = pc_max(out_ab, pc_max(out_bc, out_ca));
    precise Real least = best * PC_WIDER_SLOP;
    if (area > least) {
      best = area;
      d = i;
    }
  }
  return d;
}

// Drops points beyond the margin and keeps four: the deepest (to `slop`), the farthest from it, the one that spans the
// largest triangle with them, and the one that adds most on the other side. Gains within noise go to the
// first in order, so that a flat contact keeps its choice.
PC_FN_LARGE void pc_reduce(PC_INOUT(NarrowPolygon) polygon, Real margin, Real slop) {
  pc_drop_beyond(polygon, margin);
  if (polygon.count <= 4u) return;
  bool turn = false;
  uint a = pc_deepest(polygon, slop);
  uint b = pc_farthest(polygon, a);
  uint c = pc_widest(polygon, a, b, turn);
  uint d = pc_fourth(polygon, a, b, c, turn);
  // the chosen ones to the front, in their order along the polygon
  uint kept = 0u;
  for (uint i = 0u; i < polygon.count; i++) {
    if (i == a || i == b || i == c || i == d) {
      pc_keep(polygon, kept, i);
      kept = kept + 1u;
    }
  }
  polygon.count = kept;
}
