// A free tree as one rigid body, once the places of its bodies are known (TREE_PLACE):
// for tree_momentum.inl. Needs tree_gap.inl.
//
// Where the host has opened a pin by more than a tenth of its arm, the tree is not turned (inverse inertia 0): impulses
// at the two ends are a couple, and so is what closes the gap. To take that back would be work: two bodies a metre
// apart that are pulled together would spin as a skater does.
PC_FN void pc_tree_whole(PC_IO Slot m, Tree t) {
  Slot root = PC_NODE(m, t.first);
  Mask free = PC_LD(tree_rows, root, TREE_MASS) > PC_REAL(0.0);
  if (!PC_ANY(free)) return;  // lint: allow (of trees with a fixed root it is not used)
  Real mass = PC_REAL(0.0);
  Vec3 centre = pc_zero3();
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Real own = PC_LD(tree_rows, n, TREE_MASS);
    precise Real sum = mass + own;
    mass = sum;
    centre = pc_madd(centre, pc_ld3_tree(PC_PASS n, TREE_PLACE), own);
  }
  Real share = pc_select(free, pc_inverse_or_zero(mass), PC_REAL(0.0));
  centre = pc_scale(centre, share);
  Sym3 inertia = pc_diagonal(PC_REAL(0.0));
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 r = pc_sub(pc_ld3_tree(PC_PASS n, TREE_PLACE), centre);
    Real own = PC_LD(tree_rows, n, TREE_MASS);
    precise Real far = pc_dot(r, r) * own;
    precise Real less = -own;
    inertia =
        pc_sym_add(inertia, pc_sym_outer(pc_sym_add(pc_lds_tree(PC_PASS n, TREE_BODY), pc_diagonal(far)), r, less));
  }
  Real wide = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    wide = pc_max(wide, pc_gap_over(PC_PASS n, pc_ld3_tree(PC_PASS n, TREE_GAP), PC_SOME));
  }
  PC_MOST(wide);
  Sym3 rigid = pc_sym_select(wide > PC_REAL(0.5), pc_diagonal(PC_REAL(0.0)), pc_sym_inverse(inertia));
  PC_ONE {
    pc_st3_tree(PC_PASS root, TREE_CENTRE, centre);
    PC_ST(tree_rows, root, TREE_ALL, share);
    pc_sts_tree(PC_PASS root, TREE_RIGID, rigid);
  }
}
