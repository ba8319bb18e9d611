// Where a tree's nodes stand, and its topology.

// `at`: of its lists (glcompute/team.glsl).
struct Tree {
  uint first;
  uint count;
  uint at;
};
PC_FN Tree pc_tree(PC_IO Slot m) {
  uint block = PC_BLOCK(m);
  uint at = block * 3u;
  Tree t;
  t.first = PC_UINT(tree_blocks, at);
  t.count = PC_UINT(tree_blocks, at + 1u);
  t.at = PC_UINT(tree_blocks, at + 2u);
  return t;
}
#ifndef PC_NO_PARENTS
PC_FN uint pc_parent(PC_IO Tree t, uint k) { return PC_UINT(tree_parents, t.first + k) >> 1u; }
// whether the tree is one body that a pin holds to a fixed one: it turns about the pin (pivot_turn.inl)
PC_FN uint pc_is_pivot(PC_IO Tree t) { return PC_UINT(tree_parents, t.first) & 1u; }
// whether some joint closes a loop with the tree
PC_FN uint pc_has_loop(PC_IO Tree t) { return (PC_UINT(tree_parents, t.first) >> 1u) & 1u; }
// whether the joint's body a is the child
PC_FN uint pc_is_flipped(PC_IO Tree t, uint k) { return PC_UINT(tree_parents, t.first + k) & 1u; }
#endif
