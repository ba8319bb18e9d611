// The second half of a spring's impulse, after the bodies have moved (net_settle.inl): its impulse on b, and what it
// turns a and b by about their centres.
struct Second {
  Vec3 impulse;
  Vec3 turn_a;
  Vec3 turn_b;
};

PC_FN Real pc_net_looseness(PC_IO Slot b) {
  Sym3 i = pc_lds_net(PC_PASS b, NET_INERTIA);
  precise Real trace = i.xx + i.yy + i.zz;
  return trace;
}
// `line` and arms of then; `couple`: what the first half had, at its own arms.
PC_FN Second pc_second_half(PC_IO Slot s, Slot a, Slot b, Vec3 line, Vec3 couple, Vec3 arm_a, Vec3 arm_b) {
  Vec3 first = pc_ld3_net(PC_PASS s, NET_IMPULSE);
  Vec3 mid_a = pc_ld3_net(PC_PASS s, NET_ARM_A);
  Vec3 mid_b = pc_ld3_net(PC_PASS s, NET_ARM_B);
  Real inverse = pc_inverse_or_zero(pc_length(line));
  Vec3 along = pc_scale(line, inverse);
  Real late = PC_LD(net_rows, s, NET_LATE);
  precise Real less = PC_REAL(1.0) - late;
  precise Real more = PC_REAL(1.0) + late;
  Vec3 same = pc_scale(first, pc_div(less, more));
  Vec3 lever = pc_add(line, pc_sub(pc_sub(mid_b, arm_b), pc_sub(mid_a, arm_a)));
  Vec3 rest = pc_add(couple, pc_cross(lever, same));
  // not where the spring has shrunk to a point, about which nothing has a lever
  Vec3 back = pc_scale(pc_cross(along, rest), inverse);
  Real most = pc_length(first);
  Real backs = pc_length(back);
  Vec3 across = pc_scale(back, pc_div(most, pc_max(pc_max(backs, most), PC_TINY)));
  Vec3 left = pc_negate(pc_add(rest, pc_cross(line, across)));
  Real loose_a = pc_net_looseness(PC_PASS a);
  Real loose_b = pc_net_looseness(PC_PASS b);
  precise Real loose = loose_a + loose_b;
  Vec3 left_a = pc_scale(left, pc_div(loose_b, pc_max(loose, PC_TINY)));
  Vec3 left_b = pc_scale(left, pc_div(loose_a, pc_max(loose, PC_TINY)));
  precise Vec3 turn_a = (left_a - pc_cross(mid_a, same)) - pc_cross(arm_a, across);
  precise Vec3 turn_b = (left_b + pc_cross(mid_b, same)) + pc_cross(arm_b, across);
  Second d;
  d.impulse = pc_add(same, across);
  d.turn_a = turn_a;
  d.turn_b = turn_b;
  return d;
}
// Adds it to sums of their bodies.
PC_FN void pc_add_second(PC_IO Slot a, Slot b, uint sums, Second d) {
  pc_st3_net(PC_PASS a, sums, pc_sub(pc_ld3_net(PC_PASS a, sums), d.impulse));
  pc_st3_net(PC_PASS b, sums, pc_add(pc_ld3_net(PC_PASS b, sums), d.impulse));
  pc_st3_net(PC_PASS a, sums + 3u, pc_add(pc_ld3_net(PC_PASS a, sums + 3u), d.turn_a));
  pc_st3_net(PC_PASS b, sums + 3u, pc_add(pc_ld3_net(PC_PASS b, sums + 3u), d.turn_b));
}
