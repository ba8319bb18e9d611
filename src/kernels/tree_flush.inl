// Takes what contacts have changed over into the velocities of a tree: one pass from the root to the leaves. Nothing is
// pending afterwards. Notation: tree_sweep.inl, tree_path.inl.
#include "tree_rows.inl"
#include "tree_store.inl"
#include "tree_momentum.inl"

// W^T times a motion, with W as contacts see it.
PC_FN Vec3 pc_seen_w_tmul(PC_IO Slot n, Slot root, Six x) {
  Vec3 seen = pc_w_tmul(PC_PASS n, TREE_W, x);
  Mask anew = PC_LD(tree_rows, root, TREE_ANEW) > PC_REAL(0.5);
  if (PC_ANY(anew)) seen = pc_select3(anew, pc_w_tmul(PC_PASS n, TREE_SEEN, x), seen);  // lint: allow (selected)
  return seen;
}
// A node follows its parent; what was pending is no more.
PC_FN void pc_flush_node(PC_IO Slot m, Tree t, uint k) {
  Slot n = PC_NODE(m, t.first + k);
  Index row = PC_ORDER(tree_order, n);
  Quad turned = PC_GATHER(node_pending, row, 0u);
  if (k == 0u) {
    Quad spun = PC_GATHER(node_pending, row, 1u);
    pc_st6_tree(PC_PASS n, TREE_X, pc_lower6_mul(pc_ldh_tree(PC_PASS n, TREE_ROOT_FACTOR), pc_six(turned.v, spun.v)));
  } else {
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    Six above = pc_ld6_tree(PC_PASS up, TREE_X);
    Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
    precise Vec3 l = above.l + pc_cross(above.a, pc_sub(pc_ld3_tree(PC_PASS n, TREE_RP), rc));
    precise Vec3 q = pc_lower_tmul(pc_lds_tree(PC_PASS n, TREE_FACTOR), turned.v) -
                     pc_seen_w_tmul(PC_PASS n, PC_NODE(m, t.first), pc_six(l, above.a));
    pc_st6_tree(PC_PASS n, TREE_X, pc_six(pc_add(l, pc_cross(rc, q)), pc_add(above.a, q)));
  }
  pc_st3_tree(PC_PASS n, TREE_CHANGE,
              pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), pc_ld3_tree(PC_PASS n, TREE_X + 3u)));
  Quad none = pc_quad(pc_zero3(), PC_REAL(0.0));
  for (uint i = 0u; i < 4u; i++) PC_SCATTER(node_pending, row, i, none);
}

// A blow is no acceleration (half_changes.inl): what it changes, by more than twice what gravity does, counts as if it
// had been there before. Bodies that joints hand it on to know nothing of a contact.
PC_FN void pc_pass_blow(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Vec3 change = pc_ld3_tree(PC_PASS n, TREE_X);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  precise Real twice = PC_INFO(h) * PC_REAL(2.0);
  Vec3 forced = pc_scale(gravity, twice);
  Quad linear = PC_GATHER(velocity_parts, body, 0u);
  Quad angular = PC_GATHER(velocity_parts, body, 1u);
  Mask blown = pc_and(pc_dot(change, change) > pc_dot(forced, forced), PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0));
  Vec3 turned = pc_scale(pc_ld3_tree(PC_PASS n, TREE_CHANGE), PC_LD(tree_rows, n, TREE_TOTAL));
  PC_SCATTER_IF(blown, velocity_parts, body, 0u, pc_quad(pc_add(linear.v, change), linear.s));
  PC_SCATTER_IF(blown, velocity_parts, body, 1u, pc_quad(pc_add(angular.v, turned), angular.s));
}

// TREE_X, by which limits are entered: of all that contacts have changed in the sub-step.
PC_FN void pc_add_turn(PC_IO Slot n, Mask some) {
  Vec3 before = pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN);
  Vec3 all = pc_add(pc_ld3_tree(PC_PASS n, TREE_X + 3u), before);
  pc_st3_tree(PC_PASS n, TREE_X + 3u, pc_select3(some, all, before));
}
// What undoes overlaps moves poses alone, later (tree_again.inl).
// TREE_X: of that and of what contacts have changed before.
PC_FN void pc_keep_push(PC_IO Slot n) {
  Vec3 turned_before = pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN);
  pc_st3_tree(PC_PASS n, TREE_PUSH_SPEED, pc_ld3_tree(PC_PASS n, TREE_X));
  pc_st3_tree(PC_PASS n, TREE_PUSH_TURN, pc_ld3_tree(PC_PASS n, TREE_CHANGE));
  pc_st3_tree(PC_PASS n, TREE_X + 3u, pc_add(pc_ld3_tree(PC_PASS n, TREE_X + 3u), turned_before));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Slot root = PC_NODE(m, t.first);
  Vec3 push = pc_zero3();
  Vec3 turn = pc_zero3();
  bool moves_poses = PC_ANY(PC_INFO(push) > PC_REAL(0.5));
  bool again = moves_poses || PC_ANY(PC_INFO(sent) > PC_REAL(0.5));
  Real touched = PC_REAL(0.0);
  if (again) {
    PC_NODES(k, 0u, t) {
      Slot n = PC_NODE(m, t.first + k);
      pc_st3_tree(PC_PASS n, TREE_PUSH_TURN, pc_ld3_tree(PC_PASS n, TREE_X + 3u));
    }
    PC_MEET;
  }
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index row = PC_ORDER(tree_order, n);
    Quad impulse = PC_GATHER(node_pending, row, 2u);
    Quad torque = PC_GATHER(node_pending, row, 3u);
    Real touch = impulse.s;
    touched = pc_max(touched, touch);
    if (again) touch = pc_max(touch, PC_LD(tree_rows, n, TREE_TOUCH));
    push = pc_add(push, impulse.v);
    PC_ONE PC_ST(tree_rows, n, TREE_TOUCH, touch);
    precise Vec3 moment = turn + torque.v + pc_cross(pc_ld3_tree(PC_PASS n, TREE_PLACE), impulse.v);
    turn = moment;
    PC_THEN(PC_DOWN(k, 0u, t)) pc_flush_node(PC_PASS m, t, k);
  }
  Real share = pc_inverse_or_zero(PC_LD(tree_rows, root, TREE_TOTAL));
  push = pc_scale(push, share);
  turn = pc_scale(turn, share);
  if (moves_poses) {
    pc_tree_conserve(PC_PASS m, t, push, turn);
    PC_MEET;
    PC_NODES(k, 0u, t) pc_keep_push(PC_PASS PC_NODE(m, t.first + k));
    PC_ONE pc_st6_tree(PC_PASS root, TREE_PUSHED, pc_six(push, turn));
    return;
  }
  PC_MOST(touched);
  Mask some = pc_or(PC_INFO(sent) < PC_REAL(0.5), touched > PC_REAL(0.0));
  pc_tree_add_changes_of(PC_PASS m, t, some, push, turn);
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_pass_blow(PC_PASS n);
    if (again) pc_add_turn(PC_PASS n, some);
  }
}
