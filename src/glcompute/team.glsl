// The loops of nodes.inl where the PC_TEAM invocations of a work group share a tree. Lists of the tree stand at t.at of
// tree_blocks (plan/forest.h, Levels): spans of nodes, levels one after the other, and groups of brothers. A span that
// is not shared (a chain) is of one invocation.
uniform bool pc_scattered;  // not in the order of the invocations
#define PC_RANK (pc_scattered ? (gl_LocalInvocationIndex * 13u + 7u) % PC_TEAM : gl_LocalInvocationIndex)
shared Real pc_found[PC_TEAM];

void pc_meet() {
  groupMemoryBarrier();
  barrier();
}
uint pc_later(uint s) {
  pc_meet();
  return s + 1u;
}
uint pc_earlier(uint s) {
  pc_meet();
  return s - 1u;
}
Real pc_most(Real x) {
  pc_found[PC_RANK] = x;
  pc_meet();
  Real most = pc_found[0];
  for (uint i = 1u; i < PC_TEAM; i++) most = pc_max(most, pc_found[i]);
  pc_meet();
  return most;
}

uint pc_spans(uint at) { return io_tree_blocks[at]; }
uint pc_span_node(uint at, uint s) { return io_tree_blocks[at + 1u + s * 2u]; }
uint pc_span_groups(uint at, uint s) { return io_tree_blocks[at + 2u + s * 2u] >> 1u; }
bool pc_is_chain(uint at, uint s) { return (io_tree_blocks[at + 2u + s * 2u] & 1u) != 0u; }
uint pc_group_node(uint at, uint g) { return io_tree_blocks[at + 3u + pc_spans(at) * 2u + g]; }

// the first node of an invocation's share from `from` on
uint pc_first(uint from) { return PC_RANK + (PC_RANK < from ? PC_TEAM : 0u); }
uint pc_down_first(uint at, uint s) {
  uint node = pc_span_node(at, s);
  return pc_is_chain(at, s) ? (PC_RANK == 0u ? node : 0xffffffffu) : node + PC_RANK;
}
uint pc_down_step(uint at, uint s) { return pc_is_chain(at, s) ? 1u : PC_TEAM; }
// groups of a span, counted from its first; a chain is one
uint pc_group_count(uint at, uint s) {
  return pc_is_chain(at, s) ? 1u : pc_span_groups(at, s + 1u) - pc_span_groups(at, s);
}
uint pc_group_begin(uint at, uint s, uint g) {
  return pc_is_chain(at, s) ? pc_span_node(at, s) : pc_group_node(at, pc_span_groups(at, s) + g);
}
uint pc_group_end(uint at, uint s, uint g) {
  return pc_is_chain(at, s) ? pc_span_node(at, s + 1u) : pc_group_node(at, pc_span_groups(at, s) + g + 1u);
}
uint pc_all_groups(uint at) { return pc_span_groups(at, pc_spans(at)); }

#define PC_NODES(k, from, t) for (uint k = pc_first(from); k < t.count; k += PC_TEAM)
#define PC_DOWN(k, from, t)                                            \
  for (uint pc_s = from; pc_s < pc_spans(t.at); pc_s = pc_later(pc_s)) \
    for (uint k = pc_down_first(t.at, pc_s); k < pc_span_node(t.at, pc_s + 1u); k += pc_down_step(t.at, pc_s))
#define PC_UP(k, t)                                                               \
  for (uint pc_s = pc_spans(t.at) - 1u; pc_s > 0u; pc_s = pc_earlier(pc_s))       \
    for (uint pc_g = PC_RANK; pc_g < pc_group_count(t.at, pc_s); pc_g += PC_TEAM) \
      for (uint k = pc_group_end(t.at, pc_s, pc_g); k-- > pc_group_begin(t.at, pc_s, pc_g);)
#define PC_CHILDREN(k, t)                                                \
  for (uint pc_g = PC_RANK; pc_g < pc_all_groups(t.at); pc_g += PC_TEAM) \
    for (uint k = pc_group_node(t.at, pc_g); k < pc_group_node(t.at, pc_g + 1u); k++)
#define PC_ALL(k, from, t) for (uint k = from; k < t.count; k++)
// clang-format off
#define PC_THEN(loop) } pc_meet(); loop {
// clang-format on
#define PC_ONE if (PC_RANK == 0u)
#define PC_MEET pc_meet()
#define PC_MOST(x) x = pc_most(x)
