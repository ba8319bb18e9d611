// joint_warm with bodies of trees: their impulses go into the solve of the tree (tree_collect), as it would answer them.
//
// Of a pin nothing lasts: its one visit solves it, and where many of them close loops in one tree, what each pushed in the sub-step
// before is more than the visits take back (nets gained 200 times the energy of their fall).
#include "tree_math.inl"
#include "joint_way.inl"
#include "node_push.inl"
#include "body_push.inl"
#include "joint_rows.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY)); Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u)); Index joint = PC_ORDER(joint_order, m);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Quad pin = PC_GATHER(joint_impulse, joint, 0u); Quad angle = PC_GATHER(joint_impulse, joint, 1u);
  pin.v = pc_zero3();
  PC_SCATTER(joint_impulse, joint, 0u, pin);
  JointImpulse j = pc_joint_warm(PC_PASS m, pin, angle);
  Vec3 torque_a = pc_moment(j.couple, pc_ld3_joint(PC_PASS m, JOINT_ARM_A), j.pin); Vec3 torque_b = pc_moment(j.couple, pc_ld3_joint(PC_PASS m, JOINT_ARM_B), j.pin);
  Mask tree_a = pc_in_tree(PC_PASS w, m, 0u); Mask tree_b = pc_in_tree(PC_PASS w, m, 1u);
  pc_apply_free(PC_PASS ia, ib, a, b, tree_a, tree_b, j.pin, torque_a, torque_b);
  pc_note_push(PC_PASS w, m, 0u, tree_a, pc_six(pc_negate(j.pin), pc_negate(torque_a)), PC_REAL(0.0));
  pc_note_push(PC_PASS w, m, 1u, tree_b, pc_six(j.pin, torque_b), PC_REAL(0.0));
}
