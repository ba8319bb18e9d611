// A tree of fourth order at the pose of a stage: arms, gaps and inertia; and one sweep of its factor.
#include "smooth_rows.inl"
#include "tree_store.inl"
#include "tree_factor.inl"
#include "tree_sweep.inl"

PC_FN Quaternion pc_smooth_facing(PC_IO Slot n) { return pc_quaternion(pc_ld3_tree(PC_PASS n, TREE_FACING), PC_LD(tree_rows, n, TREE_FACING + 3u)); }
// The pose of a node, its position for now where the factor will stand.
PC_FN void pc_smooth_pose(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u); Quad place = PC_GATHER(pose, body, 0u); Quad turned = PC_GATHER(pose, body, 1u); Quad low = PC_GATHER(pose, body, 2u);
  pc_st3_tree(PC_PASS n, TREE_H, place.v); pc_st3_tree(PC_PASS n, TREE_H + 3u, low.v);
  pc_st3_tree(PC_PASS n, TREE_FACING, turned.v); PC_ST(tree_rows, n, TREE_FACING + 3u, turned.s);
  if (!PC_ANY(PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0))) { pc_sts_tree(PC_PASS n, TREE_BODY, pc_diagonal(PC_REAL(0.0))); pc_sts_tree(PC_PASS n, TREE_INERTIA, pc_diagonal(PC_REAL(0.0))); return; }  // lint: allow (what stands has none)
  Sym3 inertia = pc_world_inertia(pc_quaternion(turned.v, turned.s), pc_ld3_tree(PC_PASS n, SMOOTH_MOMENTS));
  pc_sts_tree(PC_PASS n, TREE_BODY, inertia); pc_sts_tree(PC_PASS n, TREE_INERTIA, inertia);
}
// Arms of a node's pin, and its gap.
PC_FN void pc_smooth_arms(PC_IO Slot n, Slot up) {
  Vec3 rc = pc_rotate(pc_smooth_facing(PC_PASS n), pc_ld3_tree(PC_PASS n, SMOOTH_ANCHOR)); Vec3 rp = pc_rotate(pc_smooth_facing(PC_PASS up), pc_ld3_tree(PC_PASS n, SMOOTH_UP_ANCHOR));
  Vec3 apart = pc_add(pc_sub(pc_ld3_tree(PC_PASS n, TREE_H), pc_ld3_tree(PC_PASS up, TREE_H)), pc_sub(pc_ld3_tree(PC_PASS n, TREE_H + 3u), pc_ld3_tree(PC_PASS up, TREE_H + 3u)));
  pc_st3_tree(PC_PASS n, TREE_RC, rc); pc_st3_tree(PC_PASS n, TREE_RP, rp); pc_st3_tree(PC_PASS n, TREE_GAP, pc_add(apart, pc_sub(rc, rp)));
  pc_st3_tree(PC_PASS n, TREE_PIN, pc_zero3());
}
PC_FN void pc_smooth_look(PC_IO Slot m, Tree t) {
  for (uint k = 0u; k < t.count; k++) pc_smooth_pose(PC_PASS PC_NODE(m, t.first + k));
  for (uint k = 1u; k < t.count; k++) pc_smooth_arms(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
}
// Takes what a sweep changed, and the pins' impulses of it.
PC_FN void pc_smooth_take(PC_IO Slot m, Tree t) {
  for (uint k = 0u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k); Real total = PC_LD(tree_rows, n, TREE_TOTAL); Vec3 spun = pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), pc_ld3_tree(PC_PASS n, TREE_X + 3u));
    pc_st3_tree(PC_PASS n, SMOOTH_U, pc_add(pc_ld3_tree(PC_PASS n, SMOOTH_U), pc_ld3_tree(PC_PASS n, TREE_X))); pc_st3_tree(PC_PASS n, SMOOTH_L, pc_madd(pc_ld3_tree(PC_PASS n, SMOOTH_L), spun, total));
    if (k > 0u) pc_st3_tree(PC_PASS n, TREE_PIN, pc_add(pc_ld3_tree(PC_PASS n, TREE_PIN), pc_ld3_tree(PC_PASS n, TREE_PUSH)));
  }
}
