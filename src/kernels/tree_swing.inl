// An arm turned, minus the arm.
PC_FN Vec3 pc_swing(PC_IO Slot n, Vec3 r) {
  Vec3 q = pc_ld3_tree(PC_PASS n, TREE_TURN); precise Real w = PC_LD(tree_rows, n, TREE_TURN + 3u) + PC_REAL(1.0);
  precise Vec3 s = pc_cross(q, r) * PC_REAL(2.0); precise Vec3 d = s * w + pc_cross(q, s); return d;
}
