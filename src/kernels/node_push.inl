// Impulses f on the side's body, for tree_flush and tree_collect to know of. `touch`: the load of a contact.
PC_FN void pc_note_push(PC_IO Way w, Slot m, uint side, Mask in_tree, Six f, Real touch) {
  if (pc_any_in_tree(w, side) == 0u) return;  // lint: allow (the same for all lanes)
  Index own = PC_WAY_EACH(m, pc_entry(w, PATH_OWN + side)); Row row = PC_ROW(node_pending, own); Quad impulse = PC_ROW_QUAD(node_pending, row, 2u); Quad torque = PC_ROW_QUAD(node_pending, row, 3u);
  impulse.v = pc_add(impulse.v, f.l); impulse.s = pc_max(impulse.s, touch); torque.v = pc_add(torque.v, f.a);
  PC_SCATTER_IF(in_tree, node_pending, own, 2u, impulse); PC_SCATTER_IF(in_tree, node_pending, own, 3u, torque);
}
