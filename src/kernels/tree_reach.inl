// How far the rows of a contact reach into trees: what a unit impulse along each row gives to each joint of the way,
// and to the root, in units in which their inertias are 1 (node_operator.inl); negative on side a. Rows come in threes:
// impulses along t1, t2, n, and couples about them. Answers between rows are sums of products over the way; what is
// pending there moves a row by the same numbers.
//
// contact_reach has for each block of slots two of how its sides meet (pc_keep_meeting); then on each side that stands
// in a tree, two slots of the root (the halves of its motion), then one a level; then as many for the couples, which
// are unset where pc_turns_matter says no. Of each row three reals.
const uint REACH_ROWS = 2u;  // where slots of rows begin
// in the first slot: the fastest approach of a row before anything remembered acted (tree_contact_warm)
const uint REACH_APPROACH = 11u;
// in the second slot: four, what rows leave to tree_contact_push, or how much they may yet be closed [N s]
const uint REACH_ROOM = 6u;
const uint REACH_PENDING = 9u;  // what was pending when the contact was visited; in slots of impulses

PC_FN Vec3 pc_ld3_reach(PC_IO Slot s, uint f) {
  return Vec3(PC_LD(contact_reach, s, f), PC_LD(contact_reach, s, f + 1u), PC_LD(contact_reach, s, f + 2u));
}
PC_FN void pc_st3_reach(PC_IO Slot s, uint f, Vec3 v) {
  PC_ST(contact_reach, s, f, v.x);
  PC_ST(contact_reach, s, f + 1u, v.y);
  PC_ST(contact_reach, s, f + 2u, v.z);
}
// how many slots a side has of a kind, all of one kind together; and the first of a side: `turns` 1 for couples
PC_FN uint pc_reach_count(Way w, uint side) { return pc_any_in_tree(w, side) * 2u + pc_depth(w, side); }
PC_FN uint pc_reach_all(Way w) { return pc_reach_count(w, 0u) + pc_reach_count(w, 1u); }
PC_FN uint pc_reach_first(Way w, uint side, uint turns) {
  return w.reach + REACH_ROWS + pc_reach_all(w) * turns + pc_reach_count(w, 0u) * side;
}
