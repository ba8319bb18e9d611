// What a limit of a tree's joint is about to do. Needs tree_rows.inl.

// How fast it is left, or crossed by the end of the sub-step where that is below 0; `now`: the rate of its slack.
PC_FN Real pc_crossing(PC_IO Slot n, uint i, Real now) {
  precise Real room = pc_max(PC_LD(tree_rows, n, TREE_SLACK + i), PC_REAL(0.0)) * PC_INFO(inverse_h);
  precise Real rate = now + room;
  return rate;
}
// Whether it does not act yet, and would be crossed by more than rounding.
PC_FN Mask pc_is_crossed(PC_IO Slot n, uint i, Real rate) {
  Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
  Mask is_limit = pc_and(kind > PC_REAL(0.5), kind < PC_REAL(1.5));
  return pc_and(is_limit, pc_and(PC_LD(tree_rows, n, TREE_ON + i) < PC_REAL(0.5), rate < PC_REAL(-0.05)));
}
