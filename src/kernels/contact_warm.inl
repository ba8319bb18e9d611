// Start of a sub-step's impulses between free bodies: what lasts of the last ones acts again (warm start), at the present
// arms.
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_warming.inl"
#include "contact_turned.inl"
#include "contact_calming.inl"

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

// What rounding takes of the impulse on a body that lies on one that stands goes to the low parts of its velocities: it is the same
// in every sub-step, and a box that slides for a second in steps of 0.1 ms would be a millimetre off in single precision.
PC_FN void pc_keep_lost(PC_IO Index i, Mask kept, BodyState before, Vec3 impulse, Vec3 torque) {
  Quad linear = PC_GATHER(velocity_parts, i, 2u); Quad angular = PC_GATHER(velocity_parts, i, 3u);
  TwoSum u = pc_two_sum(before.v, pc_scale(impulse, before.inverse_mass)); TwoSum l = pc_two_sum(before.l, pc_scale(torque, before.response));
  PC_SCATTER_IF(kept, velocity_parts, i, 2u, pc_quad(pc_snap3(pc_add(linear.v, u.low)), linear.s));
  PC_SCATTER_IF(kept, velocity_parts, i, 3u, pc_quad(pc_snap3(pc_add(angular.v, l.low)), angular.s));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u); Index ib = PC_ENDS(contact_ends, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u); Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  Mask far = pc_or(pc_turns_far(PC_PASS a, moved_a), pc_turns_far(PC_PASS b, moved_b));
  Real scale = pc_mass_scale(PC_PASS m, arms, a, b);
  Real exact = pc_select(PC_LD(contact_rows, m, ROW_K) > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  PC_ST(contact_rows, m, ROW_SCALE, pc_select(far, exact, scale));
  Wrench w = pc_warm_start(PC_PASS m);
  if (PC_ANY(far)) {  // lint: allow (a share of one changes nothing)
    Real calming = pc_clamp(pc_calming_share(a, b, arms, w.impulse, w.couple), PC_REAL(0.0), PC_REAL(1.0)); Real share = pc_select(far, calming, PC_REAL(1.0));
    w.impulse = pc_scale(w.impulse, share); w.couple = pc_scale(w.couple, share);
    for (uint i = 0u; i < 7u; i++) { precise Real kept = PC_LD(contact_impulses, m, i) * share; PC_ST(contact_impulses, m, i, kept); }
  }
  BodyState a0 = a; BodyState b0 = b; Real zero = PC_REAL(0.0);
  pc_apply(PC_PASS ia, ib, a, b, arms, w.impulse, w.couple);
  Mask on_a = pc_and(b0.inverse_mass > zero, a0.inverse_mass < PC_TINY); Mask on_b = pc_and(a0.inverse_mass > zero, b0.inverse_mass < PC_TINY);
  if (PC_ANY(on_a)) pc_keep_lost(PC_PASS ib, on_a, b0, w.impulse, pc_add(w.couple, pc_cross(arms.b, w.impulse)));  // lint: allow (others keep theirs)
  if (PC_ANY(on_b)) pc_keep_lost(PC_PASS ia, on_b, a0, pc_negate(w.impulse), pc_negate(pc_add(w.couple, pc_cross(arms.a, w.impulse))));  // lint: allow (others keep theirs)
}
