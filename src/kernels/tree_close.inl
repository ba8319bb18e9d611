// After the bodies have moved: what Newton's steps left of gaps, closed to rounding along the tree. Positions alone, by far less than
// bodies move, and of a free tree without its centre of mass; wider gaps are the push's (tree_again.inl), which spares what is heavy.

#include "tree_gap.inl"

// Gap of a node's pin at the poses of now.
PC_FN Vec3 pc_gap_now(PC_IO Tree t, Slot n, uint k) {
  Slot up = PC_NODE(n, t.first + pc_parent(PC_PASS t, k)); Index body = PC_ENDS(tree_ends, n, 0u); Index above = PC_ENDS(tree_ends, up, 0u); Index joint = PC_ENDS(tree_ends, n, 1u);
  uint b = pc_is_flipped(PC_PASS t, k); Quad anchor_c = PC_GATHER(joint_solved, joint, (1u - b) * 2u); Quad anchor_p = PC_GATHER(joint_solved, joint, b * 2u);
  Quad place = PC_GATHER(pose, body, 0u); Quad turned = PC_GATHER(pose, body, 1u); Quad low = PC_GATHER(pose, body, 2u);
  Quad place_up = PC_GATHER(pose, above, 0u); Quad turned_up = PC_GATHER(pose, above, 1u); Quad low_up = PC_GATHER(pose, above, 2u);
  Vec3 rc = pc_rotate(pc_quaternion(turned.v, turned.s), anchor_c.v); Vec3 rp = pc_rotate(pc_quaternion(turned_up.v, turned_up.s), anchor_p.v);
  return pc_add(pc_add(pc_sub(place.v, place_up.v), pc_sub(low.v, low_up.v)), pc_sub(rc, rp));
}

PC_FN void pc_tree_close(PC_IO Slot m, Tree t) {
  if (pc_is_pivot(PC_PASS t) == 1u) return;  // pivot_turn closes its own
  precise Real noise = PC_INFO(rounding) * PC_INFO(rounding); Real open = PC_REAL(0.0); Real wide = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k); Vec3 gap = pc_gap_now(PC_PASS t, n, k); pc_st3_tree(PC_PASS n, TREE_C, gap);
    Real over = pc_gap_over(PC_PASS n, gap, noise); open = pc_max(open, over); Real far = pc_gap_over(PC_PASS n, gap, PC_REAL(1e-4)); wide = pc_max(wide, far);
  }
  PC_MOST(open); PC_MOST(wide);
  Slot root = PC_NODE(m, t.first); Mask closes = pc_and(open > PC_REAL(0.5), wide < PC_REAL(0.5));
  if (!PC_ANY(closes)) return;  // lint: allow (selected below)
  PC_ONE pc_st3_tree(PC_PASS root, TREE_X, pc_zero3());
  PC_MEET;
  PC_DOWN(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k); pc_st3_tree(PC_PASS n, TREE_X, pc_sub(pc_ld3_tree(PC_PASS PC_NODE(m, t.first + pc_parent(PC_PASS t, k)), TREE_X), pc_ld3_tree(PC_PASS n, TREE_C)));
  }
  PC_MEET;
  Vec3 mean = pc_zero3();
  PC_ALL(k, 0u, t) { Slot n = PC_NODE(m, t.first + k); mean = pc_madd(mean, pc_ld3_tree(PC_PASS n, TREE_X), PC_LD(tree_rows, n, TREE_MASS)); }
  PC_MEET;
  mean = pc_select3(PC_LD(tree_rows, root, TREE_MASS) > PC_REAL(0.0), mean, pc_zero3());  // on a fixed root only the bodies below move
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k); Index body = PC_ENDS(tree_ends, n, 0u); Mask moves = pc_and(closes, PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0));
    Vec3 shift = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X), mean);
    Quad place = PC_GATHER(pose, body, 0u); Quad low = PC_GATHER(pose, body, 2u); Quad moved = PC_GATHER(delta, body, 0u);
    TwoSum there = pc_two_sum(place.v, pc_add(low.v, shift));
    PC_SCATTER_IF(moves, pose, body, 0u, pc_quad(there.sum, place.s)); PC_SCATTER_IF(moves, pose, body, 2u, pc_quad(pc_snap3(there.low), low.s));
    PC_SCATTER_IF(moves, delta, body, 0u, pc_quad(pc_add(moved.v, shift), moved.s));
  }
  PC_MEET;
}
