// End of a sub-step: the pose moves with the velocities.
// Position: p + h u as a sum of two reals (Knuth's two-sum), so that motion below the last place is kept.
// Rotation under constant world angular momentum L, by splitting the free rigid body
//   H = |L|^2 / (2 I_m) + (1/I_a - 1/I_m) Pi_a^2 / 2 + (1/I_c - 1/I_m) Pi_c^2 / 2,   Pi = q* L,
// with m the axis of the middle moment: the first term is one world rotation about L and commutes with the
// rest; the other two are rotations about body axes, composed as half a, c, half a (Strang), c the axis of the
// smallest moment: of the six splittings that keep symmetric bodies exact this is the best all round on the flips
// and the tumble of the tests, eight times better on the flips than the other order. L is exact.
// Two equal moments: the middle one is among them, one term vanishes and the motion is exact; three equal
// moments: one rotation. (McLachlan and Quispel, Splitting methods, Acta Numerica 11, 2002, section 3.)
// Where every body has three equal moments (PC_ROUND) only that rotation is left: the same bits, less work.

PC_FN Real pc_two_sum_error(Real a, Real b, Real sum) {
  precise Real bb = sum - a;
  precise Real aa = sum - bb;
  precise Real eb = b - bb;
  precise Real ea = a - aa;
  precise Real e = ea + eb;
  return e;
}

#ifdef PC_ROUND
PC_FN Quaternion pc_free_rotation(Quaternion q, Vec3 l, Quad inverse, Real h) {
  precise Real world_time = inverse.v.x * h;
  return pc_normalise(pc_quaternion_mul(pc_rotation(pc_scale(l, world_time)), q));
}
#else
// Turns the body by `angle` about its own axis: q * rotation, and Pi with it.
struct Spin { Quaternion q; Vec3 pi; };
PC_FN Spin pc_body_turn(Spin s, Vec3 axis, Real rate, Real time) {
  precise Real angle = pc_dot(axis, s.pi) * rate * time;
  Quaternion r = pc_axis_rotation(axis, angle);
  Spin o; o.q = pc_quaternion_mul(s.q, r); o.pi = pc_rotate(pc_conjugate(r), s.pi); return o;
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
  Spin s; s.q = q; s.pi = pc_rotate(pc_conjugate(q), l);
  s = pc_body_turn(s, a, rate_a, half_h);
  s = pc_body_turn(s, c, rate_c, h);
  s = pc_body_turn(s, a, rate_a, half_h);
  precise Real world_time = im * h;
  return pc_normalise(pc_quaternion_mul(pc_rotation(pc_scale(l, world_time)), s.q));
}
#endif

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad inverse = PC_GATHER(mass, i, 1u);
  Quad place = PC_GATHER(pose, i, 0u);
  Quad turned = PC_GATHER(pose, i, 1u);
  Quad low = PC_GATHER(pose, i, 2u);
  Quad moved = PC_GATHER(delta, i, 0u);
  Quad rotated = PC_GATHER(delta, i, 1u);
  Real h = PC_INFO(h);

  Vec3 step = pc_scale(linear.v, h);
  Vec3 small = pc_add(low.v, step);
  Vec3 sum = pc_add(place.v, small);
  low.v = pc_snap3(Vec3(pc_two_sum_error(place.v.x, small.x, sum.x), pc_two_sum_error(place.v.y, small.y, sum.y), pc_two_sum_error(place.v.z, small.z, sum.z)));
  place.v = sum;

  Quaternion before = pc_quaternion(turned.v, turned.s);
  Quaternion after = pc_free_rotation(before, angular.v, inverse, h);
  Quaternion change = pc_quaternion_mul(after, pc_conjugate(before));
  Real two = pc_select(change.w < PC_REAL(0.0), PC_REAL(-2.0), PC_REAL(2.0));
  turned.v = after.v; turned.s = after.w;
  moved.v = pc_add(moved.v, step);
  rotated.v = pc_madd(rotated.v, change.v, two);

  PC_SCATTER(pose, i, 0u, place);
  PC_SCATTER(pose, i, 1u, turned);
  PC_SCATTER(pose, i, 2u, low);
  PC_SCATTER(delta, i, 0u, moved);
  PC_SCATTER(delta, i, 1u, rotated);
}
