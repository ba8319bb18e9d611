// Start of a sub-step's impulses: what lasts of the last ones acts again (warm start), at the present arms.
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_lasting.inl"

// Where an arm has grown since the start of the step, the frozen effective masses are too large, by up to
// (K + dK) / K with dK <= growth of arm^2 times trace I^-1; fast bodies would overshoot and gain energy.
PC_FN Real pc_arm_growth(Vec3 arm, Vec3 frozen, BodyState b) {
  precise Real longer = pc_dot(arm, arm) - pc_dot(frozen, frozen);
  precise Real growth = pc_max(longer, PC_REAL(0.0)) * (b.inertia.xx + b.inertia.yy + b.inertia.zz) * b.response; return growth;
}
PC_FN Real pc_mass_scale(PC_IO Slot m, Arms arms, BodyState a, BodyState b) {
  Real k = PC_LD(contact_rows, m, ROW_K);
  precise Real now = k + pc_arm_growth(arms.a, pc_ld3_rows(PC_PASS m, ROW_ARM_A), a) + pc_arm_growth(arms.b, pc_ld3_rows(PC_PASS m, ROW_ARM_B), b);
  precise Real scale = k * pc_inverse_or_zero(now); return scale;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u); Index ib = PC_ENDS(contact_ends, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u); Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  PC_ST(contact_rows, m, ROW_SCALE, pc_mass_scale(PC_PASS m, arms, a, b));
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N); Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T); Vec3 t2 = pc_cross(n, t1);
  Lasting l = pc_lasting(PC_PASS m);
  PC_ST(contact_impulses, m, IMPULSE_BEFORE, l.load);
  PC_ST(contact_impulses, m, 0u, l.l0); PC_ST(contact_impulses, m, 1u, l.l1); PC_ST(contact_impulses, m, 2u, l.l2); PC_ST(contact_impulses, m, 3u, l.l3);
  precise Real f1 = PC_LD(contact_impulses, m, IMPULSE_T) * l.share; precise Real f2 = PC_LD(contact_impulses, m, IMPULSE_T + 1u) * l.share; precise Real twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u) * l.share;
  PC_ST(contact_impulses, m, IMPULSE_T, f1); PC_ST(contact_impulses, m, IMPULSE_T + 1u, f2); PC_ST(contact_impulses, m, IMPULSE_T + 2u, twist);
  Push push = pc_push(PC_PASS m, l.l0, l.l1, l.l2, l.l3);
  pc_apply(PC_PASS ia, ib, a, b, arms, pc_combine(t1, f1, t2, f2, n, push.n), pc_combine(t1, push.m1, t2, push.m2, n, twist));
}
