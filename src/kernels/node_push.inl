// Impulses f on the side's body, for tree_flush and tree_collect to know of.
PC_FN void pc_note_push(PC_IO Way w, Slot m, uint side, Mask in_tree, Six f) {
  if (pc_any_in_tree(w, side) == 0u) return;  // lint: allow (the same for all lanes)
  Index own = PC_EACH(contact_paths, m, pc_entry(w, PATH_OWN + side)); Quad impulse = PC_GATHER(node_pending, own, 2u); Quad torque = PC_GATHER(node_pending, own, 3u);
  impulse.v = pc_add(impulse.v, f.l); torque.v = pc_add(torque.v, f.a);
  PC_SCATTER_IF(in_tree, node_pending, own, 2u, impulse); PC_SCATTER_IF(in_tree, node_pending, own, 3u, torque);
}
