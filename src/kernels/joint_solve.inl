// Visits a joint: the angle rows one after the other, then the pin block (the original's order), as soft
// constraints with accumulated impulses. The relax pass is this same text with soft_rate 0, mass scale 1,
// impulse scale 0.
#include "body_state.inl"
#include "joint_rows.inl"
#include "joint_apply.inl"
#include "joint_limits.inl"
#ifdef PC_DRIVES
#include "drive_terms.inl"
#include "joint_drive_rows.inl"
#endif

// Change of the pin's impulse at the relative velocity of its ends.
PC_FN Vec3 pc_pin_change(PC_IO Slot m, Vec3 rate, Vec3 impulse) {
  precise Vec3 wanted = rate + pc_ld3_joint(PC_PASS m, JOINT_GAP) * PC_INFO(soft_rate);
  Vec3 answer = pc_sym_mul(pc_lds_joint(PC_PASS m, JOINT_K), wanted);
  precise Real minus_scale = -PC_INFO(soft_mass_scale);
  precise Vec3 change = answer * minus_scale - impulse * PC_INFO(soft_impulse_scale);
  return pc_within_most(PC_PASS m, impulse, change);
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(joint_ends, m, 0u);
  Index ib = PC_ENDS(joint_ends, m, 1u);
  Index joint = PC_ORDER(joint_order, m);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad place_a = PC_GATHER(pose, ia, 0u);
  Quad low_a = PC_GATHER(pose, ia, 2u);
  Quad place_b = PC_GATHER(pose, ib, 0u);
  Quad low_b = PC_GATHER(pose, ib, 2u);
  Quad pin = PC_GATHER(joint_impulse, joint, 0u);
  Quad angle = PC_GATHER(joint_impulse, joint, 1u);

  Sym3 both = pc_sym_add(pc_responding_inertia(a), pc_responding_inertia(b));
  Vec3 wa = pc_angular_velocity(a);
  Vec3 wb = pc_angular_velocity(b);
  Vec3 couple = pc_angle_steps(PC_PASS m, pc_sub(wb, wa), both, angle);
#ifdef PC_DRIVES
  couple = pc_add(couple, pc_drive_steps(PC_PASS m, pc_add(pc_sub(wb, wa), pc_sym_mul(both, couple)), both));
#endif

  // pin, with the angles' couple already acting
  precise Real minus_response = -a.response;
  Vec3 la = pc_madd(a.l, couple, minus_response);
  Vec3 lb = pc_madd(b.l, couple, b.response);
  Vec3 apart = pc_add(pc_sub(place_b.v, place_a.v), pc_sub(low_b.v, low_a.v));
  PinArms arms = pc_common_arms(pc_ld3_joint(PC_PASS m, JOINT_ARM_A), pc_ld3_joint(PC_PASS m, JOINT_ARM_B), apart);
  Vec3 va = pc_add(a.v, pc_cross(pc_sym_mul(a.inertia, la), arms.a));
  Vec3 vb = pc_add(b.v, pc_cross(pc_sym_mul(b.inertia, lb), arms.b));
  Vec3 rate = pc_sub(vb, va);
  Vec3 change = pc_pin_change(PC_PASS m, rate, pin.v);
#ifdef PC_DRIVES
  change = pc_select3(pc_is_spring(PC_PASS m), pc_spring_change(PC_PASS m, rate, pin.v), change);
#endif
  pin.v = pc_snap3(pc_add(pin.v, change));
  PC_SCATTER(joint_impulse, joint, 0u, pin);
  PC_SCATTER(joint_impulse, joint, 1u, angle);
  pc_joint_apply(PC_PASS ia, ib, a, b, arms.a, arms.b, change, couple);
}
