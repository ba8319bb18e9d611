// Impulses f on the side's body, for tree_flush and tree_collect to know of. `touch`: the load of a contact. Lanes
// whose body stands in no tree write zeros to row 0.
PC_FN void pc_note_push(PC_IO Way w, Slot m, uint side, Mask in_tree, Six f, Real touch) {
  if (pc_any_in_tree(w, side) == 0u) return;  // lint: allow (the same for all lanes)
  Vec3 zero = pc_zero3();
  Index own = PC_WAY_EACH(m, pc_entry(w, PATH_OWN + side));
  Row row = PC_ROW(node_pending, own);
  Quad impulse = PC_ROW_QUAD(node_pending, row, 2u);
  Quad torque = PC_ROW_QUAD(node_pending, row, 3u);
  impulse.v = pc_add(impulse.v, pc_select3(in_tree, f.l, zero));
  impulse.s = pc_max(impulse.s, pc_select(in_tree, touch, zero.x));
  torque.v = pc_add(torque.v, pc_select3(in_tree, f.a, zero));
  PC_SCATTER(node_pending, own, 2u, impulse);
  PC_SCATTER(node_pending, own, 3u, torque);
}
