// How far a pin stands open.
// 1 where a gap of a node's pin is more than a share, given as its square, of the body's arm. (That of its parent may
// be long: an anchor's.)
PC_FN Real pc_gap_over(PC_IO Slot n, Vec3 gap, Real share_squared) {
  Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
  precise Real most = pc_dot(rc, rc) * share_squared;
  return pc_select(pc_dot(gap, gap) > most, PC_REAL(1.0), PC_REAL(0.0));
}
