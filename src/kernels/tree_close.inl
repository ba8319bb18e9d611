// After the bodies have moved: what Newton's steps left of gaps, closed to rounding along the tree. Positions alone, by
// far less than bodies move, and of a free tree without its centre of mass. The push (tree_again.inl), which spares
// what is heavy, has what is wider than a thousandth of an arm, and trees that touch something or are dragged, which a
// shift would move into what they touch.

// Gap of a node's pin at the poses of now.
PC_FN Vec3 pc_gap_now(PC_IO Tree t, Slot n, uint k) {
  Slot up = PC_NODE(n, t.first + pc_parent(PC_PASS t, k));
  Index body = PC_ENDS(tree_ends, n, 0u);
  Index above = PC_ENDS(tree_ends, up, 0u);
  Index joint = PC_ENDS(tree_ends, n, 1u);
  uint b = pc_is_flipped(PC_PASS t, k);
  Quad anchor_c = PC_GATHER(joint_solved, joint, (1u - b) * 2u);
  Quad anchor_p = PC_GATHER(joint_solved, joint, b * 2u);
  Quad place = PC_GATHER(pose, body, 0u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Quad low = PC_GATHER(pose, body, 2u);
  Quad place_up = PC_GATHER(pose, above, 0u);
  Quad turned_up = PC_GATHER(pose, above, 1u);
  Quad low_up = PC_GATHER(pose, above, 2u);
  Vec3 rc = pc_rotate(pc_quaternion(turned.v, turned.s), anchor_c.v);
  Vec3 rp = pc_rotate(pc_quaternion(turned_up.v, turned_up.s), anchor_p.v);
  return pc_add(pc_add(pc_sub(place.v, place_up.v), pc_sub(low.v, low_up.v)), pc_sub(rc, rp));
}

// 1 where the root is moved by the host.
PC_FN Real pc_is_driven(PC_IO Slot root) {
  Index body = PC_ENDS(tree_ends, root, 0u);
  Real most = pc_max(pc_largest(PC_GATHER(motion, body, 0u).v), pc_largest(PC_GATHER(motion, body, 1u).v));
  return pc_select(pc_and(pc_nonzero(most), PC_LD(tree_rows, root, TREE_MASS) < PC_LEAST), PC_REAL(1.0), PC_REAL(0.0));
}
// 1 where a gap is more than rounding, and none so wide that the push has it.
// Gaps are kept where the tree `may` close them.
PC_FN Real pc_to_close(PC_IO Slot m, Tree t, Mask may) {
  precise Real noise = PC_INFO(rounding) * PC_INFO(rounding);
  Real open = PC_REAL(0.0);
  Real barred = pc_select(may, PC_REAL(0.0), PC_REAL(1.0));
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 gap = pc_gap_now(PC_PASS t, n, k);
    pc_st3_tree(PC_PASS n, TREE_C, pc_select3(may, gap, pc_ld3_tree(PC_PASS n, TREE_C)));
    open = pc_max(open, pc_gap_over(PC_PASS n, gap, noise));
    barred = pc_max(barred, pc_gap_over(PC_PASS n, gap, PC_SLIGHT));
  }
  PC_MOST(open);
  PC_MOST(barred);
  return pc_select(barred < PC_LEAST, open, PC_REAL(0.0));
}
// The shifts that close all gaps at once, at TREE_X: of the root none.
PC_FN void pc_closing_shifts(PC_IO Slot m, Tree t) {
  PC_ONE pc_st3_tree(PC_PASS PC_NODE(m, t.first), TREE_X, pc_zero3());
  PC_MEET;
  PC_DOWN(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 up = pc_ld3_tree(PC_PASS PC_NODE(m, t.first + pc_parent(PC_PASS t, k)), TREE_X);
    pc_st3_tree(PC_PASS n, TREE_X, pc_sub(up, pc_ld3_tree(PC_PASS n, TREE_C)));
  }
  PC_MEET;
}
// Shifts a node so, less what its centre of mass would be shifted by.
PC_FN void pc_shift_node(PC_IO Slot n, Vec3 mean, Mask closes) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Mask moves = pc_and(closes, PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0));
  Quad place = PC_GATHER(pose, body, 0u);
  Quad low = PC_GATHER(pose, body, 2u);
  TwoSum there = pc_two_sum(place.v, pc_add(low.v, pc_sub(pc_ld3_tree(PC_PASS n, TREE_X), mean)));
  PC_SCATTER_IF(moves, pose, body, 0u, pc_quad(there.sum, place.s));
  PC_SCATTER_IF(moves, pose, body, 2u, pc_quad(pc_snap3(there.low), low.s));
}
// Returns what the angular momentum of a free tree, about its root's centre, gained by that.
PC_FN Vec3 pc_tree_close(PC_IO Slot m, Tree t) {
  Vec3 gained = pc_zero3();
  // pivot_turn closes its own; a loop would open where it is closed
  if (pc_is_pivot(PC_PASS t) == 1u || pc_has_loop(PC_PASS t) == 1u) return gained;
  Slot root = PC_NODE(m, t.first);
  Real barred = pc_is_driven(PC_PASS root);
  PC_NODES(k, 0u, t) barred = pc_max(barred, PC_LD(tree_rows, PC_NODE(m, t.first + k), TREE_TOUCH));
  PC_MOST(barred);
  Mask may = barred < PC_LEAST;
  if (!PC_ANY(may)) return gained;  // lint: allow (other lanes keep what they have)
  Mask closes = pc_to_close(PC_PASS m, t, may) > PC_REAL(0.5);
  if (!PC_ANY(closes)) return gained;  // lint: allow (selected below)
  pc_closing_shifts(PC_PASS m, t);
  Vec3 mean = pc_zero3();
  Vec3 push = pc_zero3();
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 shift = pc_ld3_tree(PC_PASS n, TREE_X);
    Quad linear = PC_GATHER(motion, PC_ENDS(tree_ends, n, 0u), 0u);
    Vec3 p = pc_scale(linear.v, PC_LD(tree_rows, n, TREE_MASS));
    push = pc_add(push, p);
    mean = pc_madd(mean, shift, PC_LD(tree_rows, n, TREE_MASS));
    gained = pc_add(gained, pc_cross(shift, p));
  }
  PC_MEET;
  Mask kept = pc_and(closes, PC_LD(tree_rows, root, TREE_MASS) > PC_REAL(0.0));
  mean = pc_select3(kept, mean, pc_zero3());
  gained = pc_select3(kept, pc_sub(gained, pc_cross(mean, push)), pc_zero3());
  PC_NODES(k, 0u, t) pc_shift_node(PC_PASS PC_NODE(m, t.first + k), mean, closes);
  PC_MEET;
  return gained;
}
