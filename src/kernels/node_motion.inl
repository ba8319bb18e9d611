// What is pending in a tree comes down to a body, and impulses on it go up to the root.
// Needs tree_path.inl, node_operator.inl.
#include "node_push.inl"

PC_FN Six pc_pending(PC_IO Way w, Slot m, uint side) {
  if (pc_any_in_tree(w, side) == 0u) {  // lint: allow (the same for all lanes; zeros otherwise)
    return pc_six(pc_zero3(), pc_zero3());
  }
  Index root = PC_WAY_EACH(m, pc_entry(w, PATH_ROOT + side));
  Quad l = PC_GATHER(node_pending, root, 0u);
  Quad a = PC_GATHER(node_pending, root, 1u);
  Six x = pc_lower6_mul(pc_root_factor(PC_PASS root), pc_six(l.v, a.v));
  uint depth = pc_depth(w, side);
  uint levels = pc_levels(w, side);
  for (uint k = 0u; k < depth; k++) {
    Index node = PC_WAY_EACH(m, pc_entry(w, levels + k));
    Quad turned = PC_GATHER(node_pending, node, 0u);
    Link link = pc_link(PC_PASS node);
    x = pc_down(link, x, pc_lower_tmul(link.factor, turned.v));
  }
  return x;
}
// Impulses f on the side's body. `in_tree`: it stands in one.
PC_FN void pc_push_tree(PC_IO Way w, Slot m, uint side, Mask in_tree, Six f) {
  if (pc_any_in_tree(w, side) == 0u) return;  // lint: allow (the same for all lanes)
  pc_note_push(PC_PASS w, m, side, in_tree, f, PC_REAL(0.0));
  uint depth = pc_depth(w, side);
  uint levels = pc_levels(w, side);
  for (uint i = 0u; i < depth; i++) {
    Index node = PC_WAY_EACH(m, pc_entry(w, levels + (depth - 1u - i)));
    Link link = pc_link(PC_PASS node);
    Vec3 t = pc_on_joint(link, f);
    Quad turned = PC_GATHER(node_pending, node, 0u);
    turned.v = pc_snap3(pc_add(turned.v, pc_lower_mul(link.factor, t)));
    PC_SCATTER_IF(pc_some(node), node_pending, node, 0u, turned);
    f = pc_up(link, f, t);
  }
  Index root = PC_WAY_EACH(m, pc_entry(w, PATH_ROOT + side));
  Six x = pc_lower6_tmul(pc_root_factor(PC_PASS root), f);
  Quad l = PC_GATHER(node_pending, root, 0u);
  Quad a = PC_GATHER(node_pending, root, 1u);
  l.v = pc_snap3(pc_add(l.v, x.l));
  a.v = pc_snap3(pc_add(a.v, x.a));
  PC_SCATTER_IF(in_tree, node_pending, root, 0u, l);
  PC_SCATTER_IF(in_tree, node_pending, root, 1u, a);
}
