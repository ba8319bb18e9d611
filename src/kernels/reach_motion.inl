// What is pending in trees moves a contact's rows, and its impulses push the trees, through contact_reach. Needs
// tree_reach.inl. `turning`: how far behind a slot that of its couples stands;
// 0 where they do not matter (reach_turning.inl).
#include "node_push.inl"

PC_FN Vec3 pc_rows_rate(PC_IO Slot s, Vec3 z) {
  return Vec3(pc_dot(pc_ld3_reach(PC_PASS s, 0u), z), pc_dot(pc_ld3_reach(PC_PASS s, 3u), z),
              pc_dot(pc_ld3_reach(PC_PASS s, 6u), z));
}
PC_FN Six pc_pending_here(PC_IO Slot m, uint at, uint turning, Vec3 z, Six v) {
  Slot s = PC_NODE(m, at);
  pc_st3_reach(PC_PASS s, REACH_PENDING, z);
  v.l = pc_add(v.l, pc_rows_rate(PC_PASS s, z));
  if (turning > 0u) {  // lint: allow (others have no use for it)
    v.a = pc_add(v.a, pc_rows_rate(PC_PASS PC_NODE(m, at + turning), z));
  }
  return v;
}
// Adds what is pending on a side to the relative velocities v, in the contact frame.
PC_FN Six pc_with_pending(PC_IO Way w, Slot m, uint side, uint turning, Six v) {
  if (pc_any_in_tree(w, side) == 0u) return v;  // lint: allow (the same for all lanes)
  uint first = pc_reach_first(w, side, 0u);
  uint levels = pc_levels(w, side);
  uint depth = pc_depth(w, side);
  Row root = PC_ROW(node_pending, PC_WAY_EACH(m, pc_entry(w, PATH_ROOT + side)));
  Quad l = PC_ROW_QUAD(node_pending, root, 0u);
  v = pc_pending_here(PC_PASS m, first, turning, l.v, v);
  Quad a = PC_ROW_QUAD(node_pending, root, 1u);
  v = pc_pending_here(PC_PASS m, first + 1u, turning, a.v, v);
  for (uint k = 0u; k < depth; k++) {
    Quad turned = PC_GATHER(node_pending, PC_WAY_EACH(m, pc_entry(w, levels + k)), 0u);
    v = pc_pending_here(PC_PASS m, first + 2u + k, turning, turned.v, v);
  }
  return v;
}
PC_FN Vec3 pc_pending_now(PC_IO Slot s, Index node, uint k, bool again) {
  if (again) {  // lint: allow (the same for all lanes)
    Quad z = PC_GATHER(node_pending, node, k);
    return z.v;
  }
  return pc_ld3_reach(PC_PASS s, REACH_PENDING);
}
PC_FN Vec3 pc_with_rows(PC_IO Slot s, Vec3 z, Vec3 f) {
  precise Vec3 next =
      z + pc_ld3_reach(PC_PASS s, 0u) * f.x + pc_ld3_reach(PC_PASS s, 3u) * f.y + pc_ld3_reach(PC_PASS s, 6u) * f.z;
  return next;
}
// Impulses f (along the rows) on what is pending in quad k of a node. Lanes without a level there write zeros to row 0.
PC_FN void pc_push_here(PC_IO Slot m, uint at, uint turning, Six f, Index node, uint k, bool again) {
  Slot s = PC_NODE(m, at);
  Vec3 before = pc_pending_now(PC_PASS s, node, k, again);
  Vec3 z = pc_with_rows(PC_PASS s, before, f.l);
  if (turning > 0u) {  // lint: allow (others have no such impulses)
    z = pc_with_rows(PC_PASS PC_NODE(m, at + turning), z, f.a);
  }
  Mask some = pc_max(pc_largest(f.l), pc_largest(f.a)) > PC_REAL(0.0);
  PC_SCATTER(node_pending, node, k, pc_quad(pc_select3(some, pc_snap3(z), before), PC_REAL(0.0)));
}
// Side b is pushed after a, which may have changed what they share.
PC_FN void pc_push_side(PC_IO Way w, Slot m, uint side, uint turning, Six f) {
  if (pc_any_in_tree(w, side) == 0u) return;  // lint: allow (the same for all lanes)
  uint first = pc_reach_first(w, side, 0u);
  uint levels = pc_levels(w, side);
  uint depth = pc_depth(w, side);
  bool again = side * w.shared_levels > 0u;
  Index root = PC_WAY_EACH(m, pc_entry(w, PATH_ROOT + side));
  pc_push_here(PC_PASS m, first, turning, f, root, 0u, again);
  pc_push_here(PC_PASS m, first + 1u, turning, f, root, 1u, again);
  for (uint k = 0u; k < depth; k++)
    pc_push_here(PC_PASS m, first + 2u + k, turning, f, PC_WAY_EACH(m, pc_entry(w, levels + k)), 0u, again);
}
// An impulse and a couple of a contact, on those of its bodies that stand in trees.
PC_FN void pc_push_trees(PC_IO Way w, Slot m, uint turning, Vec3 t1, Vec3 t2, Vec3 n, Vec3 impulse, Vec3 couple,
                         Vec3 torque_a, Vec3 torque_b, Real touch) {
  pc_note_push(PC_PASS w, m, 0u, pc_in_tree(PC_PASS w, m, 0u), pc_six(pc_negate(impulse), pc_negate(torque_a)), touch);
  pc_note_push(PC_PASS w, m, 1u, pc_in_tree(PC_PASS w, m, 1u), pc_six(impulse, torque_b), touch);
  Vec3 along = Vec3(pc_dot(t1, impulse), pc_dot(t2, impulse), pc_dot(n, impulse));
  Vec3 about = Vec3(pc_dot(t1, couple), pc_dot(t2, couple), pc_dot(n, couple));
  pc_push_side(PC_PASS w, m, 0u, turning, pc_six(along, about));
  pc_push_side(PC_PASS w, m, 1u, turning, pc_six(along, about));
}
