// Once a sub-step, after tree_respond: how whole trees answer the rows of a joint that closes a loop in one of them, or
// joins two. Within one tree an impulse on one body also moves the other, through the nearest common node.
//
// What a tree holds by itself (the axis of a planar linkage's hinges, the line between two pins on one body) answers
// nothing but rounding: the pin gets a compliance, a share of what the bare bodies would answer, and the angle rows are
// no heavier than bare ones allow.
#include "body_state.inl"
#include "tree_math.inl"
#include "joint_way.inl"
#include "node_operator.inl"
#include "node_response.inl"
#include "joint_rows.inl"
#ifdef PC_DRIVES
#include "drive_terms.inl"
#include "joint_drive_rows.inl"

PC_FN Real pc_answer_along(PC_IO Slot m, uint i, Sym3 answer) {
  Vec3 axis = pc_ld3_joint(PC_PASS m, JOINT_DRIVE_AXIS + i * 3u);
  return pc_max(pc_dot(axis, pc_sym_mul(answer, axis)), PC_REAL(0.0));
}

// The angular velocity that an impulse at the arm makes.
PC_FN Vec3 pc_spin_by(Sym6 side, Vec3 impulse) { return pc_mat_tmul(side.c, impulse); }
#endif

// Of a bare body: the sum of its answers at the arm, along three axes.
PC_FN Real pc_bare_answer(BodyState b, Vec3 arm) {
  precise Real sum = (b.inverse_mass + (b.inverse_mass + b.inverse_mass)) + pc_turning_answer(b, arm);
  return sum;
}
PC_FN Six pc_across_at(PC_IO Way w, Slot m, Vec3 arm, Six f) {
  Six x = pc_across(PC_PASS w, m, f);
  precise Vec3 l = x.l + pc_cross(x.a, arm);
  return pc_six(l, x.a);
}
PC_FN Sym3 pc_less_twice(Sym3 m, Vec3 x, Vec3 y, Vec3 z) {
  precise Real xx = m.xx - (x.x + x.x);
  precise Real xy = m.xy - (y.x + x.y);
  precise Real xz = m.xz - (z.x + x.z);
  precise Real yy = m.yy - (y.y + y.y);
  precise Real yz = m.yz - (z.y + y.z);
  precise Real zz = m.zz - (z.z + z.z);
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
// Takes what passes across a common node out of the sum of both sides.
PC_FN Sym6 pc_take_across(PC_IO Way w, Slot m, Vec3 arm_a, Vec3 arm_b, Sym6 g) {
  Real one = PC_REAL(1.0);
  Real none = PC_REAL(0.0);
  Vec3 zero = pc_zero3();
  Vec3 x = Vec3(one, none, none);
  Vec3 y = Vec3(none, one, none);
  Vec3 z = Vec3(none, none, one);
  Six fx = pc_across_at(PC_PASS w, m, arm_b, pc_six(x, pc_cross(arm_a, x)));
  Six fy = pc_across_at(PC_PASS w, m, arm_b, pc_six(y, pc_cross(arm_a, y)));
  Six fz = pc_across_at(PC_PASS w, m, arm_b, pc_six(z, pc_cross(arm_a, z)));
  Six tx = pc_across_at(PC_PASS w, m, arm_b, pc_six(zero, x));
  Six ty = pc_across_at(PC_PASS w, m, arm_b, pc_six(zero, y));
  Six tz = pc_across_at(PC_PASS w, m, arm_b, pc_six(zero, z));
  Sym6 r;
  r.l = pc_less_twice(g.l, fx.l, fy.l, fz.l);
  r.a = pc_less_twice(g.a, tx.a, ty.a, tz.a);
  // velocities of the pin that couples cause: those of b from a's, and those of a from b's by symmetry
  precise Vec3 ca = g.c.a - (Vec3(tx.l.x, ty.l.x, tz.l.x) + fx.a);
  precise Vec3 cb = g.c.b - (Vec3(tx.l.y, ty.l.y, tz.l.y) + fy.a);
  precise Vec3 cc = g.c.c - (Vec3(tx.l.z, ty.l.z, tz.l.z) + fz.a);
  r.c = pc_mat3(ca, cb, cc);
  return r;
}
PC_FN void pc_st3_joint(PC_IO Slot m, uint f, Vec3 v) {
  PC_ST(joint_rows, m, f, v.x);
  PC_ST(joint_rows, m, f + 1u, v.y);
  PC_ST(joint_rows, m, f + 2u, v.z);
}
PC_FN void pc_sts_joint(PC_IO Slot m, uint f, Sym3 k) {
  pc_st3_joint(PC_PASS m, f, pc_row0(k));
  PC_ST(joint_rows, m, f + 3u, k.yy);
  PC_ST(joint_rows, m, f + 4u, k.yz);
  PC_ST(joint_rows, m, f + 5u, k.zz);
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY));
  Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Vec3 arm_a = pc_ld3_joint(PC_PASS m, JOINT_ARM_A);
  Vec3 arm_b = pc_ld3_joint(PC_PASS m, JOINT_ARM_B);
  Sym6 side_a = pc_side_response(PC_PASS w, m, 0u, ia, arm_a);
  Sym6 side_b = pc_side_response(PC_PASS w, m, 1u, ib, arm_b);
  Sym6 g = pc_sym6_add(side_a, side_b);
  if (w.below_a + w.below_b >
      0u) {  // lint: allow (the same for all lanes; where a joint is not within one tree it takes out zeros)
    g = pc_take_across(PC_PASS w, m, arm_a, arm_b, g);
  }
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  precise Real give = (pc_bare_answer(a, arm_a) + pc_bare_answer(b, arm_b)) * PC_INFO(loop_give);
  Sym3 k = pc_sym_inverse(pc_sym_add(g.l, pc_diagonal(give)));
  pc_sts_joint(PC_PASS m, JOINT_K, k);
  PC_ST(joint_rows, m, JOINT_GIVE, give);
  pc_sts_joint(PC_PASS m, JOINT_TURN, g.a);
  pc_st3_joint(PC_PASS m, JOINT_MOVE, g.c.a);
  pc_st3_joint(PC_PASS m, JOINT_MOVE + 3u, g.c.b);
  pc_st3_joint(PC_PASS m, JOINT_MOVE + 6u, g.c.c);
  pc_st3_joint(PC_PASS m, JOINT_NEAR_A, arm_a);
  pc_st3_joint(PC_PASS m, JOINT_NEAR_B, arm_b);
  for (uint i = 0u; i < 3u; i++) {
    Vec3 axis = pc_ld3_joint(PC_PASS m, JOINT_AXIS + i * 3u);
    Real bare = PC_LD(joint_rows, m, JOINT_MASS + i);
    precise Real answer = pc_dot(axis, pc_sym_mul(g.a, axis)) + pc_inverse_or_zero(bare) * PC_SOME;
    PC_ST(joint_rows, m, JOINT_MASS + i, pc_select(bare > PC_REAL(0.0), pc_inverse_or_zero(answer), PC_REAL(0.0)));
  }
#ifdef PC_DRIVES
  Mask is_spring = pc_is_spring(PC_PASS m);
  Vec3 line = pc_ld3_joint(PC_PASS m, JOINT_DRIVE_AXIS);
  Real most = pc_spring_most(PC_PASS pc_spin_by(side_a, line), pc_spin_by(side_b, line));
  PC_ST(joint_rows, m, JOINT_MOTOR_MOST, pc_select(is_spring, most, PC_LD(joint_rows, m, JOINT_MOTOR_MOST)));
  Sym3 along = pc_sym_select(is_spring, g.l, g.a);
  pc_drive_coefficients(PC_PASS m, Vec3(pc_answer_along(PC_PASS m, 0u, along), pc_answer_along(PC_PASS m, 1u, along),
                                        pc_answer_along(PC_PASS m, 2u, along)));
#endif
}
