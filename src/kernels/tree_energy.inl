// Twice an energy, by the whole tree's mass.
PC_FN Real pc_node_energy(PC_IO Slot n, Vec3 v, Vec3 w) {
  Real turning = pc_dot(w, pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), w));
  precise Real twice = pc_dot(v, v) * PC_LD(tree_rows, n, TREE_MASS) + turning;
  return twice;
}
// Of the tree's bodies as they move now, all of them.
PC_FN Real pc_tree_energy(PC_IO Slot m, Tree t) {
  Real sum = PC_REAL(0.0);
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
    Mask moves = PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0);
    Real own = pc_node_energy(PC_PASS n, b.v, pc_angular_velocity(b));
    precise Real all = sum + pc_select(moves, own, PC_REAL(0.0));
    sum = all;
  }
  return sum;
}
