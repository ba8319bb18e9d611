// How the two sides of a slot answer impulses, through the ways of tree_path.inl.
// Needs node_operator.inl, body_state.inl.
#include "node_answer.inl"

// Of one side, at its arm: as a body among joints, or a free one; a body of a tree answers nothing but with it.
PC_FN Sym6 pc_side_response(PC_IO Way w, Slot m, uint side, Index body, Vec3 arm) {
  Sym6 g = pc_response(PC_PASS PC_WAY_EACH(m, pc_entry(w, PATH_OWN + side)));
  BodyState b = pc_body_state(PC_PASS body);
  Vec3 zero = pc_zero3();
  Mask in_tree = pc_in_tree(PC_PASS w, m, side);
  Sym6 r = pc_sym6(
      pc_sym_select(in_tree, g.l, pc_diagonal(b.inverse_mass)),
      pc_mat3(pc_select3(in_tree, g.c.a, zero), pc_select3(in_tree, g.c.b, zero), pc_select3(in_tree, g.c.c, zero)),
      pc_sym_select(in_tree, g.a, pc_responding_inertia(b)));
  return pc_response_at(r, arm);
}

// How body b of a tree moves when body a of it feels the impulses f.
PC_FN Six pc_across(PC_IO Way w, Slot m, Six f) {
  uint levels_a = pc_levels_below(w, 0u);
  uint levels_b = pc_levels_below(w, 1u);
  for (uint i = 0u; i < w.below_a; i++) {
    Link link = pc_link(PC_PASS PC_WAY_EACH(m, pc_entry(w, levels_a + (w.below_a - 1u - i))));
    f = pc_up(link, f, pc_on_joint(link, f));
  }
  Six x = pc_sym6_mul(pc_response(PC_PASS PC_WAY_EACH(m, pc_entry(w, PATH_COMMON))), f);
  for (uint k = 0u; k < w.below_b; k++)
    x = pc_down(pc_link(PC_PASS PC_WAY_EACH(m, pc_entry(w, levels_b + k))), x, pc_zero3());
  return x;
}
