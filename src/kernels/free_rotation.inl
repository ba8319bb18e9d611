// Free rotation of a rigid body over a sub-step.
// Rotation under constant world angular momentum L, by splitting the free rigid body
//   H = |L|^2 / (2 I_m) + (1/I_a - 1/I_m) Pi_a^2 / 2 + (1/I_c - 1/I_m) Pi_c^2 / 2,   Pi = q* L,
// with m the axis of the middle moment: the first term is one world rotation about L and commutes with the
// rest; the other two are rotations about body axes, composed as half a, c, half a (Strang), c the axis of the
// smallest moment: of the six splittings that keep symmetric bodies exact this is the best all round on the flips
// and the tumble of the tests, eight times better on the flips than the other order. L is exact.
// Two equal moments: the middle one is among them, one term vanishes and the motion is exact; three equal
// moments: one rotation. (McLachlan and Quispel, Splitting methods, Acta Numerica 11, 2002, section 3.)

// What a sub-step changes in an orientation q: W q B - q = (W - 1) (q B) + q (B - 1).
PC_FN Quaternion pc_change(Turn world, Quaternion q, Turn body) {
  Quaternion inner = pc_quaternion_mul(q, pc_quaternion(body.q.v, body.fall));
  precise Vec3 v = q.v + inner.v; precise Real w = q.w + inner.w;
  Quaternion outer = pc_quaternion_mul(pc_quaternion(world.q.v, world.fall), pc_quaternion(v, w));
  precise Vec3 both_v = inner.v + outer.v; precise Real both_w = inner.w + outer.w;
  return pc_quaternion(both_v, both_w);
}

// Turns the body by rate * time * (its momentum along `axis`) about its own axis: appends to the turn, and Pi follows.
struct Spin { Turn turn; Vec3 pi; };
PC_FN Spin pc_body_turn(Spin s, Vec3 axis, Real rate, Real time) {
  precise Real angle = pc_dot(axis, s.pi) * rate * time;
  Turn r = pc_axis_turn(axis, angle);
  Spin o; o.turn = pc_turn_mul(s.turn, r); o.pi = pc_rotate(pc_conjugate(r.q), s.pi); return o;
}

PC_FN Quaternion pc_free_rotation(Quaternion q, Vec3 l, Quad moments, Real h) {
  Vec3 inverse = moments.v;
  Mask first = moments.s < PC_REAL(0.5);
  Mask last = moments.s > PC_REAL(1.5);
  Vec3 x = Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0));
  Vec3 y = Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  Vec3 z = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(1.0));
  Vec3 before = pc_select3(first, y, x);
  Vec3 behind = pc_select3(last, y, z);
  Mask lighter = pc_dot(before, inverse) > pc_dot(behind, inverse);
  Vec3 a = pc_select3(lighter, behind, before);
  Vec3 c = pc_select3(lighter, before, behind);
  Real im = pc_select(first, inverse.x, pc_select(last, inverse.z, inverse.y));
  precise Real rate_a = pc_dot(a, inverse) - im;
  precise Real rate_c = pc_dot(c, inverse) - im;
  precise Real half_h = h * PC_REAL(0.5);
  Spin s; s.turn.q = pc_quaternion(pc_zero3(), PC_REAL(1.0)); s.turn.fall = PC_REAL(0.0); s.pi = pc_rotate(pc_conjugate(q), l);
  s = pc_body_turn(s, a, rate_a, half_h);
  s = pc_body_turn(s, c, rate_c, h);
  s = pc_body_turn(s, a, rate_a, half_h);
  precise Real world_time = im * h;
  return pc_change(pc_turn(pc_scale(l, world_time)), q, s.turn);
}
