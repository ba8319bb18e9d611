// After the bodies have moved: closes what is left of gaps, and takes back the velocities that closed the gaps. Poses
// keep what they moved, velocities never held it. Both momenta are kept at the places of now.
#include "tree_rows.inl"
#include "tree_store.inl"
#include "tree_gap.inl"
#include "tree_whole.inl"
#include "tree_momentum.inl"
#include "tree_close.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Slot root = PC_NODE(m, t.first);
  Real fastest = PC_REAL(0.0);
  Vec3 gained = pc_tree_close(PC_PASS m, t);
  Index first = PC_ENDS(tree_ends, root, 0u);
  Quad place = PC_GATHER(pose, first, 0u);
  Quad low = PC_GATHER(pose, first, 2u);
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index body = PC_ENDS(tree_ends, n, 0u);
    Quad here = PC_GATHER(pose, body, 0u);
    Quad here_low = PC_GATHER(pose, body, 2u);
    pc_st3_tree(PC_PASS n, TREE_PLACE, pc_add(pc_sub(here.v, place.v), pc_sub(here_low.v, low.v)));
    fastest = pc_max(fastest, pc_max(pc_largest(pc_ld3_tree(PC_PASS n, TREE_PUSH_SPEED)),
                                     pc_largest(pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN))));
    pc_st3_tree(PC_PASS n, TREE_X, pc_negate(pc_ld3_tree(PC_PASS n, TREE_PUSH_SPEED)));
    pc_st3_tree(PC_PASS n, TREE_CHANGE, pc_negate(pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN)));
  }
  if (pc_is_pivot(PC_PASS t) == 1u) return;  // pivot_turn has given it no velocity
  fastest = pc_max(fastest, pc_largest(gained));
  PC_MOST(fastest);
  pc_tree_whole(PC_PASS m, t);
  Mask pushed = fastest > PC_REAL(0.0);
  if (!PC_ANY(pushed)) return;  // lint: allow (a push of nothing changes nothing)
  Vec3 push = pc_ld3_tree(PC_PASS root, TREE_PUSHED);
  Quad linear = PC_GATHER(motion, first, 0u);
  Vec3 moment = pc_sub(pc_ld3_tree(PC_PASS root, TREE_PUSHED + 3u), pc_cross(pc_scale(linear.v, PC_INFO(h)), push));
  pc_tree_add_changes_of(PC_PASS m, t, pushed, pc_negate(push), pc_negate(pc_add(moment, gained)));
}
