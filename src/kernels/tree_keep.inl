// The same as joint_keep, of joints that stand in trees.
#define PC_NO_PARENTS
#include "tree_shape.inl"
#undef PC_NO_PARENTS
#include "remembered.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  PC_NODES(k, 1u, t) pc_rescale_joint(PC_PASS PC_ENDS(tree_ends, PC_NODE(m, t.first + k), 1u));
}
