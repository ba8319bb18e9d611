// Before tree_solve: what contacts exert on a tree's bodies from the start of the sub-step.
#include "tree_rows.inl"
#include "tree_store.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index row = PC_ORDER(tree_order, n);
    Real share = pc_inverse_or_zero(PC_LD(tree_rows, n, TREE_TOTAL));
    Quad impulse = PC_GATHER(node_pending, row, 2u);
    Quad torque = PC_GATHER(node_pending, row, 3u);
    pc_st6_tree(PC_PASS n, TREE_OUTSIDE, pc_six(pc_scale(impulse.v, share), pc_scale(torque.v, share)));
  }
}
