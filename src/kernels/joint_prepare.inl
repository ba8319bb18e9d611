// Start of a sub-step's joints that stand in no tree: rows at the present pose, and what lasts of the last sub-step's
// impulses, which joint_warm and tree_joint_warm let act again.
//
// Pin (section 9.3 of the original; errata v): K = (1/m_a + 1/m_b) 1 - [r_a] I_a^-1 [r_a] - [r_b] I_b^-1 [r_b].
// Both arms end in the midpoint of the two pins, so impulses conserve angular momentum exactly.
// Angles: joint_angles.inl. Every row is a slack >= 0, measured from the nearer limit, or a locked angle.
#include "body_state.inl"
#include "joint_angles.inl"
#include "angle_rows.inl"
#include "joint_rows.inl"

PC_FN void pc_st3_joint(PC_IO Slot m, uint f, Vec3 v) {
  PC_ST(joint_rows, m, f, v.x);
  PC_ST(joint_rows, m, f + 1u, v.y);
  PC_ST(joint_rows, m, f + 2u, v.z);
}

PC_FN Sym3 pc_pin_block(BodyState a, BodyState b, Vec3 ra, Vec3 rb) {
  // columns of -[r] I^-1 [r]: r x (I^-1 (e_k x r)) with the sign of e_k x r
  Vec3 x = Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0));
  Vec3 y = Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  Vec3 z = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(1.0));
  Vec3 ax = pc_cross(ra, x);
  Vec3 ay = pc_cross(ra, y);
  Vec3 az = pc_cross(ra, z);
  Vec3 bx = pc_cross(rb, x);
  Vec3 by = pc_cross(rb, y);
  Vec3 bz = pc_cross(rb, z);
  Vec3 iax = pc_scale(pc_sym_mul(a.inertia, ax), a.response);
  Vec3 iay = pc_scale(pc_sym_mul(a.inertia, ay), a.response);
  Vec3 iaz = pc_scale(pc_sym_mul(a.inertia, az), a.response);
  Vec3 ibx = pc_scale(pc_sym_mul(b.inertia, bx), b.response);
  Vec3 iby = pc_scale(pc_sym_mul(b.inertia, by), b.response);
  Vec3 ibz = pc_scale(pc_sym_mul(b.inertia, bz), b.response);
  precise Real k = a.inverse_mass + b.inverse_mass;
  precise Real xx = k + pc_dot(ax, iax) + pc_dot(bx, ibx);
  precise Real xy = pc_dot(ax, iay) + pc_dot(bx, iby);
  precise Real xz = pc_dot(ax, iaz) + pc_dot(bx, ibz);
  precise Real yy = k + pc_dot(ay, iay) + pc_dot(by, iby);
  precise Real yz = pc_dot(ay, iaz) + pc_dot(by, ibz);
  precise Real zz = k + pc_dot(az, iaz) + pc_dot(bz, ibz);
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}

// One angle row at its nearer limit; writes it and returns its impulse.
PC_FN Real pc_angle_row(PC_IO Slot m, uint row, Vec3 axis, Real angle, Real lower, Real upper, Mask exists,
                        Real remembered, Sym3 inertia) {
  NearerLimit limit = pc_nearer_limit(PC_PASS angle, lower, upper, exists);
  Mask locked = limit.locked;
  Real sign = limit.sign;
  Real slack = limit.slack;
  Vec3 j = pc_scale(axis, sign);
  Real mass = pc_select(exists, pc_inverse_or_zero(pc_dot(j, pc_sym_mul(inertia, j))), PC_REAL(0.0));
  precise Real signed_impulse = remembered * sign * PC_INFO(impulse_ratio);
  Real impulse = pc_select(mass > PC_REAL(0.0), pc_select(locked, signed_impulse, pc_max(signed_impulse, PC_REAL(0.0))),
                           PC_REAL(0.0));
  pc_st3_joint(PC_PASS m, JOINT_AXIS + row * 3u, j);
  PC_ST(joint_rows, m, JOINT_SLACK + row, slack);
  PC_ST(joint_rows, m, JOINT_MASS + row, mass);
  PC_ST(joint_rows, m, JOINT_SIGN + row, sign);
  PC_ST(joint_rows, m, JOINT_LOCKED + row, pc_select(locked, PC_REAL(1.0), PC_REAL(0.0)));
  precise Real result = impulse * sign;
  return result;
}

// All three, from the joint frames fa and fb; answers their impulses.
PC_FN Vec3 pc_angle_rows(PC_IO Slot m, Index joint, BodyState a, BodyState b, Quaternion fa, Quaternion fb, Real kind,
                         Vec3 remembered) {
  Vec3 lower = PC_GATHER(joint_solved, joint, 4u).v;
  Vec3 upper = PC_GATHER(joint_solved, joint, 5u).v;
  Mask any = kind > PC_REAL(0.5);
  Mask is_cone = pc_and(any, kind < PC_REAL(2.0));
  Mask is_angles = kind > PC_REAL(1.0);
  Angles angles = pc_joint_angles(fa, fb, is_cone);
  Vec3 now = angles.value;
  Sym3 both = pc_sym_add(pc_responding_inertia(a), pc_responding_inertia(b));
  Real c0 = pc_angle_row(PC_PASS m, 0u, angles.roll_axis, now.x, lower.x, upper.x, any, remembered.x, both);
  Real c1 = pc_angle_row(PC_PASS m, 1u, angles.second_axis, now.y, lower.y, upper.y, any, remembered.y, both);
  Real c2 = pc_angle_row(PC_PASS m, 2u, angles.third_axis, now.z, lower.z, upper.z, is_angles, remembered.z, both);
  return Vec3(c0, c1, c2);
}

// A force F that pulls a body at its arm swings it with omega^2 = F times this (plan/loops.cpp has the same).
PC_FN Real pc_swing_ratio(BodyState b, Vec3 arm) {
  precise Real ratio = pc_turning_answer(b, arm) * pc_inverse_or_zero(pc_length(arm));
  return ratio;
}

// A pull that swings a body with h omega above 1 makes energy: the pin gives way to it.
PC_FN Real pc_most_of_pin(PC_IO BodyState a, BodyState b, Vec3 arm_a, Vec3 arm_b, Real largest_force) {
  Real ratio = pc_max(pc_swing_ratio(a, arm_a), pc_swing_ratio(b, arm_b));
  precise Real most = largest_force * PC_INFO(h);
  precise Real swings = PC_INFO(inverse_h) * pc_inverse_or_zero(ratio);
  Mask given = most > PC_REAL(0.0);
  Mask bounded = swings > PC_REAL(0.0);
  return pc_select(pc_and(given, bounded), pc_min(most, swings), pc_max(most, swings));
}
// `ra`, `rb`: from each centre of mass to its own pin; `apart`: from a's to b's.
PC_FN void pc_pin_rows(PC_IO Slot m, BodyState a, BodyState b, Vec3 ra, Vec3 rb, Vec3 apart, Real largest_force) {
  Vec3 gap = pc_add(apart, pc_sub(rb, ra));
  Vec3 arm_a = pc_madd(ra, gap, PC_REAL(0.5));
  Vec3 arm_b = pc_sub(arm_a, apart);
  Sym3 k = pc_sym_inverse(pc_pin_block(a, b, arm_a, arm_b));
  pc_st3_joint(PC_PASS m, JOINT_ARM_A, arm_a);
  pc_st3_joint(PC_PASS m, JOINT_ARM_B, arm_b);
  pc_st3_joint(PC_PASS m, JOINT_GAP, gap);
  PC_ST(joint_rows, m, JOINT_MOST, pc_most_of_pin(PC_PASS a, b, arm_a, arm_b, largest_force));
  pc_st3_joint(PC_PASS m, JOINT_K, Vec3(k.xx, k.xy, k.xz));
  pc_st3_joint(PC_PASS m, JOINT_K + 3u, Vec3(k.yy, k.yz, k.zz));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(joint_ends, m, 0u);
  Index ib = PC_ENDS(joint_ends, m, 1u);
  Index joint = PC_ORDER(joint_order, m);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad place_a = PC_GATHER(pose, ia, 0u);
  Quad turn_a = PC_GATHER(pose, ia, 1u);
  Quad low_a = PC_GATHER(pose, ia, 2u);
  Quad place_b = PC_GATHER(pose, ib, 0u);
  Quad turn_b = PC_GATHER(pose, ib, 1u);
  Quad low_b = PC_GATHER(pose, ib, 2u);
  Quad anchor_a = PC_GATHER(joint_solved, joint, 0u);
  Quad axes_a = PC_GATHER(joint_solved, joint, 1u);
  Quad anchor_b = PC_GATHER(joint_solved, joint, 2u);
  Quad axes_b = PC_GATHER(joint_solved, joint, 3u);
  Quad pin = PC_GATHER(joint_impulse, joint, 0u);
  Quad angle = PC_GATHER(joint_impulse, joint, 1u);
  Quaternion qa = pc_quaternion(turn_a.v, turn_a.s);
  Quaternion qb = pc_quaternion(turn_b.v, turn_b.s);
  Vec3 apart = pc_add(pc_sub(place_b.v, place_a.v), pc_sub(low_b.v, low_a.v));
  pc_pin_rows(PC_PASS m, a, b, pc_rotate(qa, anchor_a.v), pc_rotate(qb, anchor_b.v), apart, anchor_b.s);
  Quaternion fa = pc_quaternion_mul(qa, pc_quaternion(axes_a.v, axes_a.s));
  Quaternion fb = pc_quaternion_mul(qb, pc_quaternion(axes_b.v, axes_b.s));
  angle.v = pc_angle_rows(PC_PASS m, joint, a, b, fa, fb, anchor_a.s, angle.v);

  precise Vec3 impulse = pin.v * PC_INFO(impulse_ratio);
  pin.v = impulse;
  PC_SCATTER(joint_impulse, joint, 0u, pin);
  PC_SCATTER(joint_impulse, joint, 1u, angle);
}
