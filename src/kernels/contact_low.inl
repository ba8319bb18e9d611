// pc_apply, but where one body stands, or is by far the heavier, what rounding drops from velocities stays in their low
// parts, as of forces: what slides or rests takes up the same share of its speed each sub-step,
// rounded the same way each time.
PC_FN void pc_kick(PC_IO Index i, PC_INOUT(BodyState) b, Vec3 impulse, Vec3 torque, Real sign, Mask uneven) {
  precise Real mass = b.inverse_mass * sign;
  precise Real response = b.response * sign;
  Mask moves = b.inverse_mass > PC_REAL(0.0);
  Quad linear_low = PC_GATHER(velocity_parts, i, 2u);
  Quad angular_low = PC_GATHER(velocity_parts, i, 3u);
  Vec3 zero = pc_zero3();
  TwoSum v = pc_two_sum(b.v, pc_madd(pc_select3(uneven, linear_low.v, zero), impulse, mass));
  TwoSum l = pc_two_sum(b.l, pc_madd(pc_select3(uneven, angular_low.v, zero), torque, response));
  b.v = v.sum;
  b.l = l.sum;
  Mask keeps = pc_and(moves, uneven);
  PC_SCATTER_IF(keeps, velocity_parts, i, 2u, pc_quad(pc_snap3(v.low), linear_low.s));
  PC_SCATTER_IF(keeps, velocity_parts, i, 3u, pc_quad(pc_snap3(l.low), angular_low.s));
}
// More than eight times as heavy as the other, or standing.
PC_FN Mask pc_uneven(BodyState a, BodyState b) {
  Real light = pc_max(a.inverse_mass, b.inverse_mass);
  precise Real little = pc_quarter(light) * PC_REAL(0.5);
  return pc_min(a.inverse_mass, b.inverse_mass) < little;
}
PC_FN void pc_apply_low(PC_IO Index ia, Index ib, PC_INOUT(BodyState) a, PC_INOUT(BodyState) b, Arms arms, Vec3 impulse,
                        Vec3 couple, Mask uneven) {
  if (PC_ANY(uneven)) {  // lint: allow (others get what pc_apply gives)
    Vec3 torque_a = pc_moment(couple, arms.a, impulse);
    Vec3 torque_b = pc_moment(couple, arms.b, impulse);
    pc_kick(PC_PASS ia, a, impulse, torque_a, PC_REAL(-1.0), uneven);
    pc_kick(PC_PASS ib, b, impulse, torque_b, PC_REAL(1.0), uneven);
    pc_store_states(PC_PASS ia, ib, a, b);
  } else {
    pc_apply(PC_PASS ia, ib, a, b, arms, impulse, couple);
  }
}
