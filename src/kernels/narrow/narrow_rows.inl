// Round shapes from their rows (narrow_bounds.inl). Needs narrow_lines.inl.
struct RoundPair {
  Round a;
  Round b;
};

// Seen from a's body.
PC_FN RoundPair pc_round_pair(Row a, Row b) {
  Quad place_a = pc_row_quad(a, 0u);
  Quad turned_a = pc_row_quad(a, 1u);
  Quad centre_a = pc_row_quad(a, 2u);
  Quad low_a = pc_row_quad(a, 3u);
  Quad place_b = pc_row_quad(b, 0u);
  Quad turned_b = pc_row_quad(b, 1u);
  Quad centre_b = pc_row_quad(b, 2u);
  Quad low_b = pc_row_quad(b, 3u);
  RoundPair r;
  r.a.p = place_a.v;
  r.a.r = place_a.s;
  r.a.u = pc_axis_y(pc_quaternion(turned_a.v, turned_a.s));
  r.a.h = centre_a.s;
  Vec3 apart = pc_add(pc_sub(centre_b.v, centre_a.v), pc_sub(low_b.v, low_a.v));
  r.b.p = pc_add(place_b.v, apart);
  r.b.r = place_b.s;
  r.b.u = pc_axis_y(pc_quaternion(turned_b.v, turned_b.s));
  r.b.h = centre_b.s;
  return r;
}
// The same with a box as b: its centre, axes and half extents.
struct RoundOnBox {
  Round a;
  Vec3 p;
  Axes axes;
  Vec3 size;
};
PC_FN RoundOnBox pc_round_on_box(Row a, Row b) {
  RoundPair pair = pc_round_pair(a, b);
  Quad turned = pc_row_quad(b, 1u);
  RoundOnBox r;
  r.a = pair.a;
  r.p = pair.b.p;
  r.axes = pc_axes(pc_quaternion(turned.v, turned.s));
  r.size = Vec3(pair.b.r, pair.b.h, pc_row_quad(b, 3u).s);
  return r;
}
PC_FN RoundContact pc_capsule_on_box(RoundOnBox s, Real margin) {
  return pc_capsule_over_box(s.a, s.p, s.axes, s.size, margin);
}
PC_FN RoundContact pc_sphere_on_box(RoundOnBox s, Real margin) {
  return pc_sphere_over_box(s.a.p, s.a.r, s.p, s.axes, s.size, margin);
}
PC_FN RoundContact pc_two_capsules(RoundPair s, Real margin) { return pc_capsules(s.a, s.b, margin); }
PC_FN RoundContact pc_two_spheres(RoundPair s, Real margin) { return pc_spheres(s.a, s.b, margin); }
