// Fills contact_reach, and sums up answers (`turns`: 1 for couples, 0 for impulses).
// Needs tree_reach.inl, node_operator.inl.
PC_FN Six pc_reach_joint(PC_IO Slot s, uint row, Link n, Six x) {
  Vec3 t = pc_on_joint(n, x);
  pc_st3_reach(PC_PASS s, row * 3u, pc_lower_mul(n.factor, t));
  return pc_up(n, x, t);
}
PC_FN void pc_reach_root(PC_IO Slot first, Slot second, uint row, Sym6 factor, Six x) {
  Six z = pc_lower6_tmul(factor, x);
  pc_st3_reach(PC_PASS first, row * 3u, z.l);
  pc_st3_reach(PC_PASS second, row * 3u, z.a);
}
// Three rows, as impulses on the side's body.
struct Three {
  Six x;
  Six y;
  Six z;
};
PC_FN Three pc_three(Six x, Six y, Six z) {
  Three r;
  r.x = x;
  r.y = y;
  r.z = z;
  return r;
}
PC_FN Three pc_reach_level(PC_IO Slot s, Link n, Three f) {
  return pc_three(pc_reach_joint(PC_PASS s, 0u, n, f.x), pc_reach_joint(PC_PASS s, 1u, n, f.y),
                  pc_reach_joint(PC_PASS s, 2u, n, f.z));
}
PC_FN void pc_reach_roots(PC_IO Slot first, Slot second, Sym6 factor, Three f) {
  pc_reach_root(PC_PASS first, second, 0u, factor, f.x);
  pc_reach_root(PC_PASS first, second, 1u, factor, f.y);
  pc_reach_root(PC_PASS first, second, 2u, factor, f.z);
}
// Of a side's impulses, and where `turns` its couples.
PC_FN void pc_reach(PC_IO Way w, Slot m, uint side, bool turns, Three impulses, Three couples) {
  if (pc_any_in_tree(w, side) == 0u) return;  // lint: allow (the same for all lanes)
  uint depth = pc_depth(w, side);
  uint levels = pc_levels(w, side);
  uint first = pc_reach_first(w, side, 0u);
  uint turning = pc_reach_all(w);
  Three f = impulses;
  Three c = couples;
  for (uint i = 0u; i < depth; i++) {
    uint k = depth - 1u - i;
    Link link = pc_link(PC_PASS PC_WAY_EACH(m, pc_entry(w, levels + k)));
    f = pc_reach_level(PC_PASS PC_NODE(m, first + 2u + k), link, f);
    if (turns) {  // lint: allow (others have no use for it)
      c = pc_reach_level(PC_PASS PC_NODE(m, first + turning + 2u + k), link, c);
    }
  }
  Sym6 factor = pc_root_factor(PC_PASS PC_WAY_EACH(m, pc_entry(w, PATH_ROOT + side)));
  pc_reach_roots(PC_PASS PC_NODE(m, first), PC_NODE(m, first + 1u), factor, f);
  if (turns) {  // lint: allow (as above)
    pc_reach_roots(PC_PASS PC_NODE(m, first + turning), PC_NODE(m, first + turning + 1u), factor, c);
  }
}
// The products of the rows of slot s with those of slot q.
PC_FN Mat3 pc_slot_products(PC_IO Slot s, Slot q) {
  Vec3 x = pc_ld3_reach(PC_PASS q, 0u);
  Vec3 y = pc_ld3_reach(PC_PASS q, 3u);
  Vec3 z = pc_ld3_reach(PC_PASS q, 6u);
  Vec3 u = pc_ld3_reach(PC_PASS s, 0u);
  Vec3 v = pc_ld3_reach(PC_PASS s, 3u);
  Vec3 w = pc_ld3_reach(PC_PASS s, 6u);
  return pc_mat3(Vec3(pc_dot(u, x), pc_dot(u, y), pc_dot(u, z)), Vec3(pc_dot(v, x), pc_dot(v, y), pc_dot(v, z)),
                 Vec3(pc_dot(w, x), pc_dot(w, y), pc_dot(w, z)));
}
// Sums over the ways of both sides: of rows with each other, and of impulses with couples.
PC_FN Sym3 pc_answers(PC_IO Way w, Slot m, uint turns) {
  Sym3 sum = pc_diagonal(PC_REAL(0.0));
  uint count = pc_reach_all(w);
  uint first = pc_reach_first(w, 0u, turns);
  for (uint i = 0u; i < count; i++) {
    Slot s = PC_NODE(m, first + i);
    Vec3 x = pc_ld3_reach(PC_PASS s, 0u);
    Vec3 y = pc_ld3_reach(PC_PASS s, 3u);
    Vec3 z = pc_ld3_reach(PC_PASS s, 6u);
    sum = pc_sym_add(sum, pc_products(x, y, z, x, y, z));
  }
  return sum;
}
PC_FN Mat3 pc_mat_add(Mat3 x, Mat3 y) { return pc_mat3(pc_add(x.a, y.a), pc_add(x.b, y.b), pc_add(x.c, y.c)); }
PC_FN Mat3 pc_mixed_answers(PC_IO Way w, Slot m) {
  Vec3 zero = pc_zero3();
  Mat3 sum = pc_mat3(zero, zero, zero);
  uint count = pc_reach_all(w);
  uint first = pc_reach_first(w, 0u, 0u);
  for (uint i = 0u; i < count; i++)
    sum = pc_mat_add(sum, pc_slot_products(PC_PASS PC_NODE(m, first + i), PC_NODE(m, first + count + i)));
  return sum;
}
