// The last sub-step's impulses act again, on bodies that stand in no tree.
#include "body_state.inl"
#include "joint_rows.inl"
#include "joint_apply.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(joint_ends, m, 0u);
  Index ib = PC_ENDS(joint_ends, m, 1u);
  Index joint = PC_ORDER(joint_order, m);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad pin = PC_GATHER(joint_impulse, joint, 0u);
  Quad angle = PC_GATHER(joint_impulse, joint, 1u);
  Vec3 couple = pc_lasting_couple(PC_PASS m, angle);
  pc_joint_apply(PC_PASS ia, ib, a, b, pc_ld3_joint(PC_PASS m, JOINT_ARM_A), pc_ld3_joint(PC_PASS m, JOINT_ARM_B),
                 pin.v, couple);
}
