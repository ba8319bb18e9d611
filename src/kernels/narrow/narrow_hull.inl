// Convex hulls as numbers of a table that src/world/hull_table.cpp writes: HullRef says where a hull's numbers begin,
// pc_hull_index and pc_hull_real read the i-th of them.
//
// Indices: number V of vertices, number F of faces; then for each face, and for an end, where its first side stands
// among the reals; then for each vertex, and for an end, where its first neighbour stands among the indices; then
// the neighbours. Reals: V vertices x y z; F faces of 13: outward normal, directions e1 and e2 in the plane, centre,
// half the root of the area; then the sides of all faces, 5 each: its first corner (x, y) along e1 and e2 from the
// centre, and the half plane nx x + ny y <= off that it bounds.
#define PC_HULL_FACE_REALS 13u
#define PC_HULL_SIDE_REALS 5u

PC_FN uint pc_hull_vertices(HullRef h) { return pc_hull_index(h, 0u); }
PC_FN uint pc_hull_faces(HullRef h) { return pc_hull_index(h, 1u); }
PC_FN Vec3 pc_hull_vec(HullRef h, uint i) {
  return Vec3(pc_hull_real(h, i), pc_hull_real(h, i + 1u), pc_hull_real(h, i + 2u));
}
PC_FN Vec3 pc_hull_vertex(HullRef h, uint v) { return pc_hull_vec(h, v * 3u); }
PC_FN uint pc_hull_face_row(HullRef h, uint f) { return pc_hull_vertices(h) * 3u + f * PC_HULL_FACE_REALS; }
PC_FN uint pc_hull_first_side(HullRef h, uint f) { return pc_hull_index(h, f + 2u); }
PC_FN uint pc_hull_sides(HullRef h, uint f) {
  uint from = pc_hull_first_side(h, f);
  uint to = pc_hull_first_side(h, f + 1u);
  return (to - from) / PC_HULL_SIDE_REALS;
}
PC_FN uint pc_hull_first_neighbour(HullRef h, uint v) { return pc_hull_index(h, pc_hull_faces(h) + v + 3u); }

// The first of the vertices farthest along l, and the first of the faces that look most along it.
PC_FN_LARGE uint pc_hull_support(HullRef h, Vec3 l) {
  uint best = 0u;
  Real most = pc_dot(pc_hull_vec(h, 0u), l);
  uint count = pc_hull_vertices(h);
  for (uint v = 1u; v < count; v++) {
    Real along = pc_dot(pc_hull_vertex(h, v), l);
    if (along > most) {
      most = along;
      best = v;
    }
  }
  return best;
}
PC_FN_LARGE uint pc_hull_facing(HullRef h, Vec3 l) {
  uint best = 0u;
  uint row = pc_hull_face_row(h, 0u);
  Real most = pc_dot(pc_hull_vec(h, row), l);
  uint count = pc_hull_faces(h);
  for (uint f = 1u; f < count; f++) {
    row = row + PC_HULL_FACE_REALS;
    Real along = pc_dot(pc_hull_vec(h, row), l);
    if (along > most) {
      most = along;
      best = f;
    }
  }
  return best;
}
// Of the edges from vertex v the one that falls off least along l: the vertex at its other end.
PC_FN_LARGE uint pc_hull_edge(HullRef h, uint v, Vec3 l) {
  Vec3 x = pc_hull_vertex(h, v);
  uint end = pc_hull_first_neighbour(h, v + 1u);
  uint first = pc_hull_first_neighbour(h, v);
  uint best = pc_hull_index(h, first);
  Real most = PC_REAL(-2.0);
  for (uint i = first; i < end; i++) {
    uint other = pc_hull_index(h, i);
    Real slope = pc_dot(pc_unit_or_zero(pc_sub(pc_hull_vertex(h, other), x)), l);
    if (slope > most) {
      most = slope;
      best = other;
    }
  }
  return best;
}
// Corners of a face, in its own coordinates.
PC_FN_LARGE void pc_hull_polygon(HullRef h, uint f, PC_INOUT(NarrowPolygon) polygon) {
  uint side = pc_hull_first_side(h, f);
  uint count = pc_hull_sides(h, f);
  polygon.count = count;
  for (uint i = 0u; i < count; i++) {
    polygon.x[i] = pc_hull_real(h, side);
    polygon.y[i] = pc_hull_real(h, side + 1u);
    side = side + PC_HULL_SIDE_REALS;
  }
}

// The corners of the face that looks most towards the plane, and the lowest vertex where that is none of them;
// feature = number of the corner in its face, and the face.
PC_FN_LARGE void pc_hull_plane(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(NarrowManifold) m) {
  Vec3 up = pc_axis_y(b.q);
  Axes axes = pc_axes(a.q);
  HullRef h = a.hull;
  Vec3 l = pc_to_local(axes, up);
  Vec3 down = pc_negate(l);
  Real height = pc_dot(up, pc_sub(a.p, b.p));
  m.normal = pc_negate(up);
  uint lowest = pc_hull_support(h, down);
  Vec3 v = pc_hull_vertex(h, lowest);
  precise Real least = height + pc_dot(l, v);
  if (least > margin) return;
  uint f = pc_hull_facing(h, down);
  uint row = pc_hull_face_row(h, f);
  Vec3 e1 = pc_hull_vec(h, row + 3u);
  Vec3 e2 = pc_hull_vec(h, row + 6u);
  Vec3 c = pc_hull_vec(h, row + 9u);
  Real half_size = pc_hull_real(h, row + 12u);
  precise Real s0 = height + pc_dot(l, c);
  Real s1 = pc_dot(l, e1);
  Real s2 = pc_dot(l, e2);
  NarrowPolygon polygon;
  pc_hull_polygon(h, f, polygon);
  for (uint i = 0u; i < polygon.count; i++) {
    precise Real s = s0 + s1 * polygon.x[i] + s2 * polygon.y[i];
    polygon.s[i] = s;
    polygon.id[i] = i;
  }
  precise Real rocking = half_size * PC_FLAT_SLOP;
  Real held_slop = least < PC_REAL(0.0) ? rocking : PC_REAL(0.0);
  precise Real deepest = least + a.size.x * PC_HELD_SLOP + held_slop;
  pc_reduce(polygon, margin, rocking);
  bool held = false;
  uint shallowest = 0u;
  for (uint i = 0u; i < polygon.count; i++) {
    held = held || polygon.s[i] <= deepest;
    if (polygon.s[i] > polygon.s[shallowest]) shallowest = i;
  }
  for (uint i = 0u; i < polygon.count; i++) {
    if (held || polygon.count < 4u || i != shallowest) {
      Vec3 x = pc_combine(e1, polygon.x[i], e2, polygon.y[i], c, PC_REAL(1.0));
      uint corner = polygon.id[i];
      pc_push_from(m, pc_add(a.p, pc_to_world(axes, x)), m.normal, PC_REAL(0.0), polygon.s[i], margin,
                   (f << 5u) | corner);
    }
  }
  if (!held)
    pc_push_from(m, pc_add(a.p, pc_to_world(axes, v)), m.normal, PC_REAL(0.0), least, margin, 0x10000u + lowest);
}
