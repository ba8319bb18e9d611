// Start of a sub-step's impulses between free bodies: what lasts of the last ones acts again (warm start), at the present
// arms.
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_warming.inl"
#include "contact_turned.inl"
#include "contact_calming.inl"
#include "contact_low.inl"
#include "contact_recalled.inl"

// Where an arm has grown since the start of the step, the frozen effective masses are too large, by up to
// (K + dK) / K with dK <= growth of arm^2 times trace I^-1; fast bodies would overshoot and gain energy.
PC_FN Real pc_arm_growth(Vec3 arm, Vec3 frozen, BodyState b) {
  precise Real longer = pc_dot(arm, arm) - pc_dot(frozen, frozen);
  precise Real growth = pc_max(longer, PC_REAL(0.0)) * (b.inertia.xx + b.inertia.yy + b.inertia.zz) * b.response; return growth;
}
PC_FN Real pc_mass_scale(PC_IO Slot m, Arms arms, BodyState a, BodyState b) {
  Real k = PC_LD(contact_rows, m, ROW_K);
  precise Real now = k + pc_arm_growth(arms.a, pc_ld3_rows(PC_PASS m, ROW_ARM_A), a) + pc_arm_growth(arms.b, pc_ld3_rows(PC_PASS m, ROW_ARM_B), b);
  precise Real scale = k * pc_inverse_or_zero(now);
  return scale;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Mask pushes = pc_pushes(PC_PASS m);
  if (!PC_ANY(pushes)) return;  // lint: allow (others change nothing)
  Index ia = PC_ENDS(contact_ends, m, 0u); Index ib = PC_ENDS(contact_ends, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u); Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  Mask far = pc_or(pc_turns_far(PC_PASS a, moved_a), pc_turns_far(PC_PASS b, moved_b));
  Real scale = pc_mass_scale(PC_PASS m, arms, a, b);
  PC_ST(contact_rows, m, ROW_SCALE, pc_select(pushes, pc_select(far, PC_REAL(1.0), scale), PC_LD(contact_rows, m, ROW_SCALE)));
  pc_keep_recalled(PC_PASS m, ia, ib, pushes);
  Wrench w = pc_warm_start(PC_PASS m, pushes);
  if (PC_ANY(far)) {  // lint: allow (a share of one changes nothing)
    Real calming = pc_clamp(pc_calming_share(a, b, arms, w.impulse, w.couple), PC_REAL(0.0), PC_REAL(1.0)); Real share = pc_select(pc_and(far, pushes), calming, PC_REAL(1.0));
    w.impulse = pc_scale(w.impulse, share); w.couple = pc_scale(w.couple, share);
    pc_keep_share(PC_PASS m, share);
  }
  pc_spare(a, pushes); pc_spare(b, pushes);
  pc_apply_low(PC_PASS ia, ib, a, b, arms, w.impulse, w.couple, pc_uneven(a, b));
}
