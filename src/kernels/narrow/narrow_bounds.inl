// How bodies move, and the boxes of shapes: what comes before the pairs. Boxes hold their shapes wherever they can come
// in the step; slack beyond rounding, also to single precision, is in them. Needs narrow_lines.inl.

// of a shape's row: (place against the body's centre, first of its sizes), orientation,
// (the body's position, second size), (its low part, third)
const uint quads_round = 4u;
// Columns of a shape: the lever of turns across its body's y axis and of any; 1 where it may move; half extents, and a
// radius besides; by how much its box is grown; how far a try of this step sent its body
const uint BOUND_ACROSS = 0u;
const uint BOUND_ANY = 1u;
const uint BOUND_MOVES = 2u;
const uint BOUND_HALF = 3u;
const uint BOUND_ROUND = 6u;
const uint BOUND_GROWN = 7u;
const uint BOUND_WENT = 8u;

// As TwistOf (collision/twist.h).
struct BodyMotion {
  Vec3 v;
  Vec3 w;
  Real speed;
  Real turn;
  Real across;
};
PC_FN BodyMotion pc_body_motion(Vec3 v, Vec3 l, Vec3 inverse_moments, Quaternion q) {
  Vec3 x = pc_axis_x(q);
  Vec3 y = pc_axis_y(q);
  Vec3 z = pc_axis_z(q);
  precise Real lx = inverse_moments.x * pc_dot(x, l);
  precise Real ly = inverse_moments.y * pc_dot(y, l);
  precise Real lz = inverse_moments.z * pc_dot(z, l);
  precise Real tilt = lx * lx + lz * lz;
  precise Real all = lx * lx + ly * ly + lz * lz;
  BodyMotion m;
  m.v = v;
  m.w = pc_combine(x, lx, y, ly, z, lz);
  m.speed = pc_length(v);
  m.turn = pc_sqrt(all);
  m.across = pc_sqrt(tilt);
  return m;
}

// Of the time step, for all bodies.
struct Stride {
  Real step;
  Real fall;
  Real largest_turn;
};
// How far a shape may come.
PC_FN Real pc_shape_reach(Stride s, Real speed, Real turn, Real across, Real lever_across, Real lever_any, Real moves,
                          Real went) {
  precise Real far = s.step * speed;
  precise Real tilted = s.step * across;
  precise Real turned = s.step * turn;
  precise Real outward = pc_min(tilted, s.largest_turn) * lever_across + pc_min(turned, s.largest_turn) * lever_any;
  precise Real reach = pc_max(far, went) + outward + s.fall;
  return pc_select(moves > PC_REAL(0.0), reach, PC_REAL(0.0));
}
// Bounds are in single precision: what a place loses in it.
#define PC_PLACE_ROUNDING PC_REAL(2e-7)
struct ShapeBox {
  Vec3 least;
  Vec3 most;
};
PC_FN ShapeBox pc_shape_box(Vec3 place, Quaternion q, Vec3 position, Vec3 low, Vec3 half_extents, Real radius,
                            Real more) {
  Vec3 x = pc_axis_x(q);
  Vec3 y = pc_axis_y(q);
  Vec3 z = pc_axis_z(q);
  Vec3 h = half_extents;
  precise Real ex = pc_abs(x.x) * h.x + pc_abs(y.x) * h.y + pc_abs(z.x) * h.z + radius;
  precise Real ey = pc_abs(x.y) * h.x + pc_abs(y.y) * h.y + pc_abs(z.y) * h.z + radius;
  precise Real ez = pc_abs(x.z) * h.x + pc_abs(y.z) * h.y + pc_abs(z.z) * h.z + radius;
  precise Vec3 c = position + (low + place);
  precise Real gx = ex * PC_SURELY + more;
  precise Real gy = ey * PC_SURELY + more;
  precise Real gz = ez * PC_SURELY + more;
  precise Real sx = gx + (pc_abs(c.x) + gx) * PC_PLACE_ROUNDING;
  precise Real sy = gy + (pc_abs(c.y) + gy) * PC_PLACE_ROUNDING;
  precise Real sz = gz + (pc_abs(c.z) + gz) * PC_PLACE_ROUNDING;
  Vec3 size = Vec3(sx, sy, sz);
  ShapeBox b;
  b.least = pc_sub(c, size);
  b.most = pc_add(c, size);
  return b;
}
