// What is pending in trees moves a contact's rows, and its impulses push the trees, through contact_reach. Needs tree_reach.inl.
#include "node_push.inl"

PC_FN Vec3 pc_rows_rate(PC_IO Slot s, uint f, Vec3 z) { return Vec3(pc_dot(pc_ld3_reach(PC_PASS s, f), z), pc_dot(pc_ld3_reach(PC_PASS s, f + 3u), z), pc_dot(pc_ld3_reach(PC_PASS s, f + 6u), z)); }
PC_FN Six pc_pending_here(PC_IO Slot s, bool turns, Vec3 z, Six v) {
  pc_st3_reach(PC_PASS s, REACH_PENDING, z); v.l = pc_add(v.l, pc_rows_rate(PC_PASS s, REACH_PUSH, z));
  if (turns) v.a = pc_add(v.a, pc_rows_rate(PC_PASS s, REACH_TURN, z));  // lint: allow (others have no use for it)
  return v;
}
// Adds what is pending on a side to the relative velocities v, in the contact frame.
PC_FN Six pc_with_pending(PC_IO Way w, Slot m, uint side, bool turns, Six v) {
  if (pc_any_in_tree(w, side) == 0u) return v;  // lint: allow (the same for all lanes)
  uint first = pc_reach_first(w, side); uint levels = pc_levels(w, side); uint depth = pc_depth(w, side);
  Row root = PC_ROW(node_pending, PC_WAY_EACH(m, pc_entry(w, PATH_ROOT + side)));
  Quad l = PC_ROW_QUAD(node_pending, root, 0u); v = pc_pending_here(PC_PASS PC_NODE(m, first), turns, l.v, v);
  Quad a = PC_ROW_QUAD(node_pending, root, 1u); v = pc_pending_here(PC_PASS PC_NODE(m, first + 1u), turns, a.v, v);
  for (uint k = 0u; k < depth; k++) {
    Quad turned = PC_GATHER(node_pending, PC_WAY_EACH(m, pc_entry(w, levels + k)), 0u); v = pc_pending_here(PC_PASS PC_NODE(m, first + 2u + k), turns, turned.v, v);
  }
  return v;
}
// Impulses f (along the rows) on what is pending at a slot: z, or what it was when the contact was visited.
PC_FN Quad pc_pushed_here(PC_IO Slot s, bool turns, Six f, Vec3 z) {
  precise Vec3 next = z + pc_ld3_reach(PC_PASS s, REACH_PUSH) * f.l.x + pc_ld3_reach(PC_PASS s, REACH_PUSH + 3u) * f.l.y + pc_ld3_reach(PC_PASS s, REACH_PUSH + 6u) * f.l.z;
  if (turns) { precise Vec3 more = next + pc_ld3_reach(PC_PASS s, REACH_TURN) * f.a.x + pc_ld3_reach(PC_PASS s, REACH_TURN + 3u) * f.a.y + pc_ld3_reach(PC_PASS s, REACH_TURN + 6u) * f.a.z; next = more; }  // lint: allow (others have no such impulses)
  return pc_quad(pc_snap3(next), PC_REAL(0.0));
}
PC_FN Vec3 pc_pending_now(PC_IO Slot s, Index node, uint k, bool again) {
  if (again) { Quad z = PC_GATHER(node_pending, node, k); return z.v; }  // lint: allow (the same for all lanes)
  return pc_ld3_reach(PC_PASS s, REACH_PENDING);
}
// Lanes without a level there write zeros to row 0. Side b is pushed after a, which may have changed what they share.
PC_FN void pc_push_side(PC_IO Way w, Slot m, uint side, bool turns, Six f) {
  if (pc_any_in_tree(w, side) == 0u) return;  // lint: allow (the same for all lanes)
  uint first = pc_reach_first(w, side); uint levels = pc_levels(w, side); uint depth = pc_depth(w, side); bool again = side * w.shared_levels > 0u;
  Index root = PC_WAY_EACH(m, pc_entry(w, PATH_ROOT + side)); Slot half_a = PC_NODE(m, first); Slot half_b = PC_NODE(m, first + 1u);
  PC_SCATTER(node_pending, root, 0u, pc_pushed_here(PC_PASS half_a, turns, f, pc_pending_now(PC_PASS half_a, root, 0u, again)));
  PC_SCATTER(node_pending, root, 1u, pc_pushed_here(PC_PASS half_b, turns, f, pc_pending_now(PC_PASS half_b, root, 1u, again)));
  for (uint k = 0u; k < depth; k++) {
    Slot s = PC_NODE(m, first + 2u + k); Index node = PC_WAY_EACH(m, pc_entry(w, levels + k));
    PC_SCATTER(node_pending, node, 0u, pc_pushed_here(PC_PASS s, turns, f, pc_pending_now(PC_PASS s, node, 0u, again)));
  }
}
