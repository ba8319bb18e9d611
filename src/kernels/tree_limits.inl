// After the contacts: limits that they turn a joint over act as well, and those that are beyond where it is held, by contacts; the tree is factored
// anew with them, for tree_again. Without, a joint that is struck goes beyond its limit by all of the sub-step's turn, and one that is held there stays.
#include "body_state.inl"
#include "tree_rows.inl"
#include "tree_store.inl"
#ifdef PC_DRIVES
#include "tree_drive.inl"
#endif
#include "angle_rows.inl"
#include "tree_factor.inl"
#include "tree_crossing.inl"

// 1 where there are any.
PC_FN Real pc_enter_limits(PC_IO Slot n, Slot up) {
  Real any = PC_REAL(0.0);
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return any;  // lint: allow (zero otherwise)
  BodyState body = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
  BodyState parent = pc_body_state(PC_PASS PC_ENDS(tree_ends, up, 0u));
  Vec3 turn = pc_sub(pc_angular_velocity(body), pc_angular_velocity(parent));
  for (uint i = 0u; i < 3u; i++) {
    Real now = pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
    Real slack = PC_LD(tree_rows, n, TREE_SLACK + i);
    precise Real lacks = now + pc_soft_bias(PC_PASS slack);
    Mask held = pc_and(slack < -PC_INFO(rounding), lacks < PC_REAL(0.0));
    Real rate = pc_select(held, lacks, pc_crossing(PC_PASS n, i, now));
    Mask enters = pc_is_crossed(PC_PASS n, i, rate);
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
  PC_ONE PC_ST(tree_rows, PC_NODE(m, t.first), TREE_ENTERED, entered);
  if (PC_ANY(entered > PC_REAL(0.5))) pc_factor(PC_PASS m, t, true);  // lint: allow (other lanes compute the same again)
}
