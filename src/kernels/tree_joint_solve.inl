// Visits a joint that closes a loop of a tree, or joins trees, inside the space that the trees' joints leave, as
// tree_contact_solve does: what is pending comes down to the bodies, the rows are solved,
// the impulse goes up to the root.
//
// The pin is rigid: its gap stays what it was over the whole sub-step (SHAKE), with the arms turned as the bodies will
// turn, so no energy is lost to the chord; and a share of the gap is closed. The relax pass is this same text with
// soft_rate 0: it looks back on the same sub-step, from the same arms, and takes out no more than what closed the gap.
#include "tree_math.inl"
#include "joint_way.inl"
#include "node_operator.inl"
#include "node_motion.inl"
#include "body_push.inl"
#include "joint_rows.inl"
#include "joint_limits.inl"
#ifdef PC_DRIVES
#include "drive_terms.inl"
#include "joint_drive_rows.inl"
#endif

// Mean velocity of a pin over the sub-step, the body turning freely from the arm with momentum l (and w, its velocity
// now): the middle's angular velocity is w + h / 2 I^-1 (L x w). Where it turns by more than half a radian the tangent,
// w x arm: what the response knows of is that alone.
PC_FN Vec3 pc_mean_velocity(PC_IO BodyState b, Vec3 v, Vec3 w, Vec3 arm, Vec3 l) {
  precise Real half_h = PC_INFO(h) * PC_REAL(0.5);
  Vec3 change = pc_scale(pc_sym_mul(b.inertia, pc_cross(l, w)), b.response);
  Vec3 angle = pc_scale(pc_madd(w, change, half_h), PC_INFO(h));
  Turn turn = pc_turn(angle);
  Vec3 moved = pc_swing_closely(turn.q, arm);
  return pc_select3(pc_dot(angle, angle) < pc_quarter(PC_REAL(1.0)), pc_madd(v, moved, PC_INFO(inverse_h)),
                    pc_add(v, pc_cross(w, arm)));
}
// Velocity that closes a share of the gap, at most joint_push_speed, and with no more energy than the lighter body has
// at push_speed: near the straight line a loop closes only as bodies turn fast.
PC_FN Vec3 pc_pin_bias(PC_IO Slot m, BodyState a, BodyState b) {
  Vec3 v = pc_scale(pc_ld3_joint(PC_PASS m, JOINT_GAP), PC_INFO(soft_rate));
  v = pc_scale(v, pc_share_within(pc_length(v), PC_INFO(joint_push_speed)));
  Real energy = pc_dot(v, pc_sym_mul(pc_lds_joint(PC_PASS m, JOINT_K), v));
  precise Real most =
      PC_INFO(push_speed) * PC_INFO(push_speed) * pc_inverse_or_zero(pc_max(a.inverse_mass, b.inverse_mass));
  return pc_scale(v, pc_share_within(pc_sqrt(pc_max(energy, PC_REAL(0.0))), pc_sqrt(most)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY));
  Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Index joint = PC_ORDER(joint_order, m);
  Six xa = pc_pending(PC_PASS w, m, 0u);
  Six xb = pc_pending(PC_PASS w, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad pin = PC_GATHER(joint_impulse, joint, 0u);
  Quad angle = PC_GATHER(joint_impulse, joint, 1u);
  Vec3 wa = pc_add(pc_angular_velocity(a), xa.a);
  Vec3 wb = pc_add(pc_angular_velocity(b), xb.a);
  Vec3 va = pc_add(a.v, xa.l);
  Vec3 vb = pc_add(b.v, xb.l);
  Vec3 couple = pc_angle_steps(PC_PASS m, pc_sub(wb, wa), pc_lds_joint(PC_PASS m, JOINT_TURN), angle);

#ifdef PC_DRIVES
  Sym3 both = pc_lds_joint(PC_PASS m, JOINT_TURN);
  couple = pc_add(couple, pc_drive_steps(PC_PASS m, pc_add(pc_sub(wb, wa), pc_sym_mul(both, couple)), both));
#endif

  // pin, with the angles' couple already acting
  Vec3 arm_a = pc_ld3_joint(PC_PASS m, JOINT_ARM_A);
  Vec3 arm_b = pc_ld3_joint(PC_PASS m, JOINT_ARM_B);
  Mat3 move = pc_mat3(pc_ld3_joint(PC_PASS m, JOINT_MOVE), pc_ld3_joint(PC_PASS m, JOINT_MOVE + 3u),
                      pc_ld3_joint(PC_PASS m, JOINT_MOVE + 6u));
  precise Vec3 rate = pc_mean_velocity(PC_PASS b, vb, wb, arm_b, b.l) -
                      pc_mean_velocity(PC_PASS a, va, wa, arm_a, a.l) + pc_mat_mul(move, couple);
  precise Vec3 wanted = rate + pc_pin_bias(PC_PASS m, a, b) + pin.v * PC_LD(joint_rows, m, JOINT_GIVE);
  Vec3 change = pc_negate(pc_sym_mul(pc_lds_joint(PC_PASS m, JOINT_K), wanted));
  change = pc_within_most(PC_PASS m, pin.v, change);
#ifdef PC_DRIVES
  precise Vec3 tangent = (vb + pc_cross(wb, arm_b)) - (va + pc_cross(wa, arm_a));
  change = pc_select3(pc_is_spring(PC_PASS m), pc_spring_change(PC_PASS m, tangent, pin.v), change);
#endif
  pin.v = pc_snap3(pc_add(pin.v, change));
  PC_SCATTER(joint_impulse, joint, 0u, pin);
  PC_SCATTER(joint_impulse, joint, 1u, angle);

  Vec3 torque_a = pc_moment(couple, pc_ld3_joint(PC_PASS m, JOINT_NEAR_A), change);
  Vec3 torque_b = pc_moment(couple, pc_ld3_joint(PC_PASS m, JOINT_NEAR_B), change);
  Mask tree_a = pc_in_tree(PC_PASS w, m, 0u);
  Mask tree_b = pc_in_tree(PC_PASS w, m, 1u);
  pc_apply_free(PC_PASS ia, ib, a, b, tree_a, tree_b, change, torque_a, torque_b);
  pc_push_tree(PC_PASS w, m, 0u, tree_a, pc_six(pc_negate(change), pc_negate(torque_a)));
  pc_push_tree(PC_PASS w, m, 1u, tree_b, pc_six(change, torque_b));
}
