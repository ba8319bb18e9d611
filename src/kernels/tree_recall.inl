// Before recall_share: bodies of a tree answer what contacts remember with all of the tree.
#include "tree_rows.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index body = PC_ENDS(tree_ends, n, 0u);
    Mask moves = PC_GATHER(motion, body, 0u).s > PC_REAL(0.0);
    Quad sum = PC_GATHER(recalled, body, 0u);
    Real answer = pc_inverse_or_zero(PC_LD(tree_rows, n, TREE_TOTAL));
    PC_SCATTER_IF(moves, recalled, body, 0u, pc_quad(sum.v, answer));
  }
}
