// Remembers what acted on the joint: pin and angle impulses of the sub-step.
PC_FN void pc_remember_joint(PC_IO Tree t, Slot n, uint k) {
  Real flip = pc_select(PC_IS(pc_is_flipped(PC_PASS t, k)), PC_REAL(-1.0), PC_REAL(1.0));
  Index joint = PC_ENDS(tree_ends, n, 1u);
  Real total = PC_LD(tree_rows, n, TREE_TOTAL);
  precise Vec3 pin = pc_ld3_tree(PC_PASS n, TREE_PIN) * flip * total;
  Vec3 s = pc_scale(pc_ld3_tree(PC_PASS n, TREE_LIMIT), total);
  precise Real r0 = s.x * PC_LD(tree_rows, n, TREE_SIGN);
  precise Real r1 = s.y * PC_LD(tree_rows, n, TREE_SIGN + 1u);
  precise Real r2 = s.z * PC_LD(tree_rows, n, TREE_SIGN + 2u);
  PC_SCATTER(joint_impulse, joint, 0u, pc_quad(pc_snap3(pin), PC_REAL(0.0)));
  PC_SCATTER(joint_impulse, joint, 1u, pc_quad(pc_snap3(Vec3(r0, r1, r2)), PC_REAL(0.0)));
}
