// A joint whose arm would swing by more than half a radian in the sub-step is braked, as by a damper inside the factor: the sub-step is
// too long for it, and what its pins leave out feeds it. The damper is a share of the joint's own inertia, TREE_BRAKE, times the rate at
// the prediction, TREE_SWING; its couple stands in TREE_PUSH, which is free in tree_solve.

// (What turns about its pin alone needs none.) `square`: of the angle that the arm would swing.
PC_FN void pc_set_brake(PC_IO Slot n, Vec3 turn, Real square) {
  precise Real beyond = square * PC_REAL(4.0) - PC_REAL(1.0); Real zero = PC_REAL(0.0);
  pc_st3_tree(PC_PASS n, TREE_SWING, turn); PC_ST(tree_rows, n, TREE_BRAKE, pc_select(PC_LD(tree_rows, n, TREE_PIVOT) > PC_REAL(0.5), zero, pc_max(beyond, zero)));
}
PC_FN Mask pc_has_brake(PC_IO Slot n) { return PC_LD(tree_rows, n, TREE_BRAKE) > PC_REAL(0.0); }
// D with the damper in it.
PC_FN Sym3 pc_with_brake(PC_IO Slot n, Sym3 bare) {
  Real brake = PC_LD(tree_rows, n, TREE_BRAKE); precise Real all = brake + PC_REAL(1.0);
  pc_st3_tree(PC_PASS n, TREE_PUSH, pc_scale(pc_sym_mul(bare, pc_ld3_tree(PC_PASS n, TREE_SWING)), brake)); return pc_sym_scale(bare, all);
}
