// After `advance`, which a body on a pivot was kept out of: its velocities, its motion since the start of the step, and
// what its joint held.
#include "tree_rows.inl"
#include "tree_joint_kept.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Slot n = PC_NODE(m, t.first + 1u);
  if (!PC_ANY(PC_LD(tree_rows, n, TREE_PIVOT) > PC_REAL(0.5))) {  // lint: allow (the same for all lanes of a block)
    return;
  }
  Index body = PC_ENDS(tree_ends, n, 0u);
  Quad linear = PC_GATHER(motion, body, 0u);
  Quad angular = PC_GATHER(motion, body, 1u);
  Quad moved = PC_GATHER(delta, body, 0u);
  Quad rotated = PC_GATHER(delta, body, 1u);
  Six velocity = pc_ld6_tree(PC_PASS n, TREE_X);
  Six way = pc_ld6_tree(PC_PASS n, TREE_F);
  precise Real square = moved.s + PC_LD(tree_rows, n, TREE_C);
  Mask exists = linear.s > PC_REAL(0.0);
  PC_SCATTER_IF(exists, motion, body, 0u, pc_quad(velocity.l, linear.s));
  PC_SCATTER_IF(exists, motion, body, 1u, pc_quad(velocity.a, angular.s));
  PC_SCATTER_IF(exists, delta, body, 0u, pc_quad(pc_add(moved.v, way.l), square));
  PC_SCATTER_IF(exists, delta, body, 1u, pc_quad(pc_add(rotated.v, way.a), PC_REAL(0.0)));
  pc_remember_joint(PC_PASS t, n, 1u);
}
