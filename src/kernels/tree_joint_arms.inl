// After the bodies have moved: arms from their places of now to one common point,
// where the impulses of the relax phase act.
#include "joint_way.inl"
#include "joint_rows.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY));
  Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Quad place_a = PC_GATHER(pose, ia, 0u);
  Quad low_a = PC_GATHER(pose, ia, 2u);
  Quad place_b = PC_GATHER(pose, ib, 0u);
  Quad low_b = PC_GATHER(pose, ib, 2u);
  Vec3 apart = pc_add(pc_sub(place_b.v, place_a.v), pc_sub(low_b.v, low_a.v));
  PinArms arms = pc_common_arms(pc_ld3_joint(PC_PASS m, JOINT_ARM_A), pc_ld3_joint(PC_PASS m, JOINT_ARM_B), apart);
  PC_ST(joint_rows, m, JOINT_NEAR_A, arms.a.x);
  PC_ST(joint_rows, m, JOINT_NEAR_A + 1u, arms.a.y);
  PC_ST(joint_rows, m, JOINT_NEAR_A + 2u, arms.a.z);
  PC_ST(joint_rows, m, JOINT_NEAR_B, arms.b.x);
  PC_ST(joint_rows, m, JOINT_NEAR_B + 1u, arms.b.y);
  PC_ST(joint_rows, m, JOINT_NEAR_B + 2u, arms.b.z);
}
