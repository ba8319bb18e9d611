// After the contacts: limits over which they turn a joint act as well, and the tree is factored anew with them, for
// tree_again. Without, a joint that is struck goes beyond its limit by all of the sub-step's turn. Contacts of the
// relax phase see the tree as it was: rows whose masses are those of another factor do not take back all that they
// pushed, and bridges under heavy ragdolls gained energy by it.
#include "tree_rows.inl"
#include "tree_store.inl"
#ifdef PC_DRIVES
#include "tree_drive.inl"
#endif
#define PC_SEEN  // contacts have looked at the factor
#include "tree_factor.inl"
#undef PC_SEEN

// 1 where there are any. TREE_X: what contacts have changed (tree_flush); TREE_RATE: what tree_solve left.
PC_FN Real pc_enter_limits(PC_IO Slot n, Slot up) {
  Real any = PC_REAL(0.0);
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return any;  // lint: allow (zero otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Mask enters = pc_enters(PC_PASS n, i, turn);
    PC_ST(tree_rows, n, TREE_ON + i, pc_select(enters, PC_REAL(1.0), PC_LD(tree_rows, n, TREE_ON + i)));
    any = pc_select(enters, PC_REAL(1.0), any);
  }
  return any;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Real entered = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    entered = pc_max(entered, pc_enter_limits(PC_PASS PC_NODE(m, t.first + k), up));
  }
  PC_MOST(entered);
  PC_ONE PC_ST(tree_rows, PC_NODE(m, t.first), TREE_ANEW, entered);
  PC_NODES(k, 0u, t) PC_ST(tree_rows, PC_NODE(m, t.first + k), TREE_STALE, entered);
  if (!PC_ANY(entered > PC_REAL(0.5))) return;  // lint: allow (other lanes compute the same again)
  pc_factor(PC_PASS m, t, true);
}
