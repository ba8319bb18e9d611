// Whether Newton's steps have found their way. From far off, after a blow or in a whip, they do not, and what they add
// is energy of any size. Where they more than double the energy of the motion within the tree, all is taken back, and
// bodies are seen ahead until they have turned by `stale_share`: pins then make none, and gaps that this leaves are
// closed by the push.
#include "tree_energy.inl"

// velocity and angular momentum before the steps; the solve has used the other
const uint TREE_KEPT_MOTION = TREE_INERTIA;
const uint TREE_KEPT_LIMIT = TREE_H + 18u;  // impulses of the angle rows, beside TREE_SEEN

PC_FN void pc_keep(PC_IO Slot n, Mask these, uint f, Vec3 v) {
  pc_st3_tree(PC_PASS n, f, pc_select3(these, v, pc_ld3_tree(PC_PASS n, f)));
}
PC_FN void pc_keep_motion(PC_IO Slot m, Tree t, Mask these) {
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
    pc_keep(PC_PASS n, these, TREE_KEPT_MOTION, b.v);
    pc_keep(PC_PASS n, these, TREE_KEPT_MOTION + 3u, b.l);
    if (k > 0u) pc_keep(PC_PASS n, these, TREE_KEPT_PIN, pc_ld3_tree(PC_PASS n, TREE_PIN));
    if (k > 0u) pc_keep(PC_PASS n, these, TREE_KEPT_LIMIT, pc_ld3_tree(PC_PASS n, TREE_LIMIT));
  }
}
// 1 where the steps have not found their way.
PC_FN Real pc_strayed(PC_IO Slot m, Tree t) {
  PC_MEET;
  BodyState root = pc_body_state(PC_PASS PC_ENDS(tree_ends, PC_NODE(m, t.first), 0u));
  Vec3 root_v = pc_ld3_tree(PC_PASS PC_NODE(m, t.first), TREE_KEPT_MOTION);
  Mask held = root.inverse_mass < PC_TINY;
  Vec3 carried = pc_select3(held, root.v, root_v);
  Real after = PC_REAL(0.0);
  Real before = PC_REAL(0.0);
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
    Six kept = pc_ld6_tree(PC_PASS n, TREE_KEPT_MOTION);
    Vec3 w = pc_sym_mul(b.inertia, kept.a);
    Real left = pc_node_energy(PC_PASS n, pc_sub(b.v, carried), pc_angular_velocity(b));
    Real of_motion = pc_node_energy(PC_PASS n, pc_sub(kept.l, carried), w);
    Mask moves = PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0);
    precise Real all_after = after + pc_select(moves, left, PC_REAL(0.0));
    precise Real all_before = before + pc_select(moves, of_motion, PC_REAL(0.0));
    after = all_after;
    before = all_before;
  }
  PC_MEET;
  precise Real most = before + before;
  return pc_select(after > most, PC_REAL(1.0), PC_REAL(0.0));
}
// All is as it was before the steps.
PC_FN void pc_take_back(PC_IO Slot m, Tree t, Mask these) {
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index body = PC_ENDS(tree_ends, n, 0u);
    Quad linear = PC_GATHER(motion, body, 0u);
    Quad angular = PC_GATHER(motion, body, 1u);
    Six kept = pc_ld6_tree(PC_PASS n, TREE_KEPT_MOTION);
    Mask moves = pc_and(these, linear.s > PC_REAL(0.0));
    PC_SCATTER_IF(moves, motion, body, 0u, pc_quad(kept.l, linear.s));
    PC_SCATTER_IF(moves, motion, body, 1u, pc_quad(kept.a, angular.s));
    if (k > 0u) pc_keep(PC_PASS n, these, TREE_PIN, pc_ld3_tree(PC_PASS n, TREE_KEPT_PIN));
    if (k > 0u) pc_keep(PC_PASS n, these, TREE_LIMIT, pc_ld3_tree(PC_PASS n, TREE_KEPT_LIMIT));
  }
}
