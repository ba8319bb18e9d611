// After the bodies have moved: takes back the push that closed the gaps, at the arms of now. Poses keep what it moved,
// velocities never held it. Both arms are drawn to one common point, so momenta are kept.
#include "tree_rows.inl"
#include "tree_store.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  for (uint k = 0u; k < t.count; k++) pc_st3_tree(PC_PASS PC_NODE(m, t.first + k), TREE_F, pc_zero3());
  for (uint k = 1u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k); Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    Index child = PC_ENDS(tree_ends, n, 0u); Index parent = PC_ENDS(tree_ends, up, 0u); Index joint = PC_ENDS(tree_ends, n, 1u);
    Quad place_c = PC_GATHER(pose, child, 0u); Quad turn_c = PC_GATHER(pose, child, 1u); Quad low_c = PC_GATHER(pose, child, 2u);
    Quad place_p = PC_GATHER(pose, parent, 0u); Quad turn_p = PC_GATHER(pose, parent, 1u); Quad low_p = PC_GATHER(pose, parent, 2u);
    uint b = pc_is_flipped(PC_PASS t, k); Quad anchor_c = PC_GATHER(joint_frame, joint, (1u - b) * 2u); Quad anchor_p = PC_GATHER(joint_frame, joint, b * 2u);
    Vec3 rc = pc_rotate(pc_quaternion(turn_c.v, turn_c.s), anchor_c.v); Vec3 rp = pc_rotate(pc_quaternion(turn_p.v, turn_p.s), anchor_p.v);
    Vec3 apart = pc_add(pc_sub(place_c.v, place_p.v), pc_sub(low_c.v, low_p.v)); Vec3 gap = pc_add(apart, pc_sub(rc, rp));
    Vec3 arm_c = pc_madd(rc, gap, PC_REAL(-0.5)); Vec3 arm_p = pc_madd(rp, gap, PC_REAL(0.5));
    Vec3 f = pc_ld3_tree(PC_PASS n, TREE_PUSH); Vec3 couple = pc_ld3_tree(PC_PASS n, TREE_PUSH_COUPLE);
    precise Vec3 torque_c = pc_ld3_tree(PC_PASS n, TREE_F) - pc_cross(arm_c, f) - couple; precise Vec3 torque_p = pc_ld3_tree(PC_PASS up, TREE_F) + pc_cross(arm_p, f) + couple;
    pc_st3_tree(PC_PASS n, TREE_F, torque_c); pc_st3_tree(PC_PASS up, TREE_F, torque_p);
  }
  for (uint k = 0u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k); Index body = PC_ENDS(tree_ends, n, 0u);
    Quad linear = PC_GATHER(motion, body, 0u); Quad angular = PC_GATHER(motion, body, 1u);
    linear.v = pc_sub(linear.v, pc_ld3_tree(PC_PASS n, TREE_PUSH_SPEED)); angular.v = pc_add(angular.v, pc_ld3_tree(PC_PASS n, TREE_F));
    PC_SCATTER_IF(linear.s > PC_REAL(0.0), motion, body, 0u, linear);
    PC_SCATTER_IF(linear.s > PC_REAL(0.0), motion, body, 1u, angular);
  }
}
