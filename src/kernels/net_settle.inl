// After the bodies of a net have moved: the second half of its springs' impulses (net_solve), and what keeps their
// energy from rising.
//
// It is (1 - beta) / (1 + beta) times the first at the same arms, and across the line of now what takes back the rest
// of the couple of the first; what of that no impulse across a line can take back, which is of the order of what the
// solve left open, the two bodies take over as a couple. So angular momentum is kept however far the solve came. What
// both halves did to the bodies is known to rounding, and so is what the springs now store beyond what they stored;
// their sum is energy made, where the solve was not exact. The net owes it, and pays from the motion of the springs'
// ends along their lines as soon as there is any: so kinetic energy never exceeds what was there.
#include "net_rows.inl"

PC_FN void pc_settle_body(PC_IO Slot b, Index row) {
  Quad linear = PC_GATHER(motion, row, 0u);
  Quad angular = PC_GATHER(motion, row, 1u);
  Quad turned = PC_GATHER(pose, row, 1u);
  Quaternion q = pc_quaternion(turned.v, turned.s);
  Vec3 inverse = PC_GATHER(mass, row, 1u).v;
  pc_st3_net(PC_PASS b, NET_VELOCITY, linear.v);
  pc_sts_net(PC_PASS b, NET_INERTIA, pc_net_inertia(q, inverse, linear.s));
  pc_st3_net(PC_PASS b, NET_SPIN, pc_sym_mul(pc_world_inertia(q, inverse), angular.v));
}
PC_FN void pc_settle_line(PC_IO Slot m, Net n, uint k) {
  Slot s = pc_net_spring(PC_PASS m, n, k);
  Index joint = pc_net_row(PC_PASS m, n, n.bodies + k);
  Index ia = pc_net_row(PC_PASS m, n, PC_UINT(nets, n.links + k * 2u));
  Index ib = pc_net_row(PC_PASS m, n, PC_UINT(nets, n.links + k * 2u + 1u));
  Quad place_a = PC_GATHER(pose, ia, 0u);
  Quad turn_a = PC_GATHER(pose, ia, 1u);
  Quad low_a = PC_GATHER(pose, ia, 2u);
  Quad place_b = PC_GATHER(pose, ib, 0u);
  Quad turn_b = PC_GATHER(pose, ib, 1u);
  Quad low_b = PC_GATHER(pose, ib, 2u);
  Vec3 ra = pc_rotate(pc_quaternion(turn_a.v, turn_a.s), PC_GATHER(joint_frame, joint, 0u).v);
  Vec3 rb = pc_rotate(pc_quaternion(turn_b.v, turn_b.s), PC_GATHER(joint_frame, joint, 2u).v);
  Vec3 apart = pc_add(pc_sub(place_b.v, place_a.v), pc_sub(low_b.v, low_a.v));
  Vec3 line = pc_add(apart, pc_sub(rb, ra));
  // START is of now from here on
  Vec3 shift_a = pc_sub(pc_ld3_net(PC_PASS s, NET_ARM_A), pc_ld3_net(PC_PASS s, NET_START));
  Vec3 shift_b = pc_sub(pc_ld3_net(PC_PASS s, NET_ARM_B), pc_ld3_net(PC_PASS s, NET_START + 3u));
  Vec3 lever = pc_add(pc_ld3_net(PC_PASS s, NET_LINE), pc_sub(shift_b, shift_a));
  pc_st3_net(PC_PASS s, NET_WAY, pc_cross(lever, pc_ld3_net(PC_PASS s, NET_IMPULSE)));
  pc_st3_net(PC_PASS s, NET_START, ra);
  pc_st3_net(PC_PASS s, NET_START + 3u, rb);
  pc_st3_net(PC_PASS s, NET_NOW, line);
}
#include "net_second.inl"
#include "net_whole.inl"

PC_FN void pc_settle_second(PC_IO Slot s, Slot a, Slot b) {
  Vec3 line = pc_ld3_net(PC_PASS s, NET_NOW);
  Vec3 couple = pc_ld3_net(PC_PASS s, NET_WAY);
  Second d = pc_second_half(PC_PASS s, a, b, line, couple, pc_ld3_net(PC_PASS s, NET_START),
                            pc_ld3_net(PC_PASS s, NET_START + 3u));
  pc_add_second(PC_PASS a, b, NET_PUSH, d);
  pc_st3_net(PC_PASS s, NET_SECOND, d.impulse);
}
// How much the spring stores beyond what it stored.
PC_FN Real pc_stored_more(PC_IO Slot s) {
  Real length = PC_LD(net_rows, s, NET_LENGTH);
  Vec3 before = pc_ld3_net(PC_PASS s, NET_LINE);
  Vec3 now = pc_ld3_net(PC_PASS s, NET_NOW);
  Real long_now = pc_length(now);
  Real rest = PC_LD(net_rows, s, NET_REST);
  // of the lines' difference, with the digits that the difference of lengths has lost
  precise Real both = length + long_now;
  precise Real longer = pc_dot(pc_sub(now, before), pc_add(now, before)) * pc_inverse_or_zero(both);
  precise Real mean = (length - rest) + (long_now - rest);
  precise Real more = PC_LD(net_rows, s, NET_STIFFNESS) * mean * longer * PC_REAL(0.5);
  return more;
}
// What the second halves do to a body's energy; of one that moves as it is told what it takes from the springs.
PC_FN Real pc_settle_work(PC_IO Slot b) {
  Vec3 push = pc_ld3_net(PC_PASS b, NET_PUSH);
  Vec3 turn = pc_ld3_net(PC_PASS b, NET_PUSH + 3u);
  precise Real half_mass = PC_LD(net_rows, b, NET_MASS) * PC_REAL(0.5);
  Vec3 v = pc_madd(pc_ld3_net(PC_PASS b, NET_VELOCITY), push, half_mass);
  Vec3 turned = pc_sym_mul(pc_lds_net(PC_PASS b, NET_INERTIA), turn);
  Vec3 w = pc_madd(pc_ld3_net(PC_PASS b, NET_SPIN), turned, PC_REAL(0.5));
  precise Real work = pc_dot(push, v) + pc_dot(turn, w);
  return work;
}
// What the springs' ends would have of energy along their lines to give, by plastic impulses that each makes alone: the
// first two terms of its change, in one share of these impulses.
struct Dues {
  Real first;
  Real second;
};
PC_FN Dues pc_settle_dues(PC_IO Slot m, Net n) {
  Dues d;
  d.first = PC_REAL(0.0);
  d.second = PC_REAL(0.0);
  pc_net_velocities(PC_PASS m, n);
  pc_net_clear(PC_PASS m, n, NET_SUM);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Slot a = pc_net_end(PC_PASS m, n, k, 0u);
    Slot b = pc_net_end(PC_PASS m, n, k, 1u);
    Vec3 ra = pc_ld3_net(PC_PASS s, NET_START);
    Vec3 rb = pc_ld3_net(PC_PASS s, NET_START + 3u);
    Vec3 along = pc_unit_or_zero(pc_ld3_net(PC_PASS s, NET_NOW));
    Real answer = pc_dot(along, pc_sym_mul(pc_net_answer(PC_PASS a, b, ra, rb), along));
    Real rate = pc_dot(along, pc_net_rate(PC_PASS a, b, ra, rb));
    precise Real impulse = -rate * pc_inverse_or_zero(answer);
    Vec3 plastic = pc_scale(along, impulse);
    pc_st3_net(PC_PASS s, NET_WAY, plastic);
    pc_net_add(PC_PASS a, b, NET_SUM, ra, rb, plastic);
    precise Real sum = d.first - impulse * rate;
    d.first = sum;
  }
  pc_net_rates(PC_PASS m, n, NET_SUM);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 ra = pc_ld3_net(PC_PASS s, NET_START);
    Vec3 rb = pc_ld3_net(PC_PASS s, NET_START + 3u);
    Vec3 rate = pc_net_rate(PC_PASS pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u), ra, rb);
    precise Real sum = d.second + pc_dot(rate, pc_ld3_net(PC_PASS s, NET_WAY));
    d.second = sum;
  }
  return d;
}

// `blow`: 1 where the first half was net_bound's, which is no change that will go on.
PC_FN void pc_settle_store(PC_IO Slot b, Index row, Real share, Real blow) {
  Quad linear = PC_GATHER(motion, row, 0u);
  Quad angular = PC_GATHER(motion, row, 1u);
  Quad before = PC_GATHER(velocity_parts, row, 0u);
  Quad angular_before = PC_GATHER(velocity_parts, row, 1u);
  Mask moves = linear.s > PC_REAL(0.0);
  Vec3 push = pc_ld3_net(PC_PASS b, NET_PUSH);
  Vec3 turn = pc_ld3_net(PC_PASS b, NET_PUSH + 3u);
  Vec3 paid = pc_scale(pc_ld3_net(PC_PASS b, NET_SUM), share);
  Vec3 paid_turn = pc_scale(pc_ld3_net(PC_PASS b, NET_SUM + 3u), share);
  precise Vec3 all = push + paid;
  precise Vec3 all_turn = turn + paid_turn;
  // the velocity that is read lacks half of what the sub-step changed: what came after it counts as if it had come
  // before, and what the rigid motion gave then is read whole
  Vec3 rigid = pc_ld3_net(PC_PASS b, NET_AFTER);
  Vec3 rigid_turn = pc_ld3_net(PC_PASS b, NET_AFTER + 3u);
  Vec3 solved = pc_scale(pc_ld3_net(PC_PASS b, NET_PUSHED), blow);
  Vec3 solved_turn = pc_scale(pc_ld3_net(PC_PASS b, NET_PUSHED + 3u), blow);
  precise Vec3 shift = (push * PC_REAL(2.0) - rigid + paid) + solved;
  precise Vec3 shift_turn = (turn * PC_REAL(2.0) - rigid_turn + paid_turn) + solved_turn;
  linear.v = pc_madd(linear.v, all, linear.s);
  before.v = pc_madd(before.v, shift, linear.s);
  Vec3 l = pc_add(angular.v, all_turn);
  angular_before.v = pc_add(angular_before.v, shift_turn);
  PC_SCATTER_IF(moves, motion, row, 0u, linear);
  PC_SCATTER_IF(moves, motion, row, 1u, pc_quad(l, angular.s));
  PC_SCATTER_IF(moves, velocity_parts, row, 0u, before);
  PC_SCATTER_IF(moves, velocity_parts, row, 1u, angular_before);
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Net n = pc_net(PC_PASS m);
  Real zero = PC_REAL(0.0);
  Real made = zero;
  Real rigid = PC_LD(net_rows, pc_net_body(PC_PASS m, n, 0u), NET_BOUND);
  Real blow = pc_select(rigid > zero, PC_REAL(1.0), zero);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    pc_settle_body(PC_PASS b, pc_net_row(PC_PASS m, n, k));
    pc_st3_net(PC_PASS b, NET_PUSHED, pc_ld3_net(PC_PASS b, NET_PUSH));
    pc_st3_net(PC_PASS b, NET_PUSHED + 3u, pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
    precise Real sum = made + PC_LD(net_rows, b, NET_MADE);
    made = sum;
  }
  pc_net_begin_after(PC_PASS m, n, NET_PUSH, zero);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    pc_st3_net(PC_PASS b, NET_AFTER, pc_ld3_net(PC_PASS b, NET_PUSH));
    pc_st3_net(PC_PASS b, NET_AFTER + 3u, pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_settle_line(PC_PASS m, n, k);
    pc_settle_second(PC_PASS s, pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u));
    precise Real sum = made + pc_stored_more(PC_PASS s);
    made = sum;
  }
  pc_net_even(PC_PASS m, n, PC_IS(1u));
  for (uint k = 0u; k < n.bodies; k++) {
    precise Real sum = made + pc_settle_work(PC_PASS pc_net_body(PC_PASS m, n, k));
    made = sum;
  }
  Index keeper = pc_net_row(PC_PASS m, n, n.bodies);
  precise Real owed = PC_GATHER(joint_impulse, keeper, 1u).v.x + made + pc_net_held(PC_PASS m, n);
  Real due = pc_max(owed, zero);
  Dues d = pc_settle_dues(PC_PASS m, n);
  // first share - second share^2 / 2 = due, or as much as there is
  precise Real inside = d.first * d.first - d.second * due * PC_REAL(2.0);
  precise Real divisor = d.first + pc_sqrt(pc_max(inside, zero));
  precise Real twice = due * PC_REAL(2.0);
  Real exact = pc_div(twice, pc_max(divisor, PC_TINY));
  Real most = pc_div(d.first, pc_max(d.second, PC_TINY));
  Real share = pc_select(d.first > PC_TINY, pc_select(inside > zero, exact, most), zero);
  precise Real paid = share * d.first - share * share * d.second * PC_REAL(0.5);
  precise Real left = due - paid;
  for (uint k = 0u; k < n.bodies; k++) {
    pc_settle_store(PC_PASS pc_net_body(PC_PASS m, n, k), pc_net_row(PC_PASS m, n, k), share, blow);
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Index joint = pc_net_row(PC_PASS m, n, n.bodies + k);
    Vec3 all = pc_add(pc_ld3_net(PC_PASS s, NET_IMPULSE), pc_ld3_net(PC_PASS s, NET_SECOND));
    Real owes = pc_select(PC_IS(k), zero, pc_snap(pc_max(left, zero)));
    PC_SCATTER(joint_impulse, joint, 0u, pc_quad(pc_snap3(all), zero));
    PC_SCATTER(joint_impulse, joint, 1u, pc_quad(Vec3(owes, zero, zero), zero));
  }
}
