// Springs between points, all of a net at once, implicit in the lengths that they will have at the end of the sub-step.
//
// A spring gives half of its impulse before the bodies move and half after (net_settle), as the implicit midpoint rule
// does:
//   F = -h (k (x + (1 + beta) (x' - x) / 2) + c (x' - x) / h) n,   n = (D + D') / (|D| + |D'|)
// with D, D' the lines between its points before and after, x, x' how much longer they are than at rest. F n is then a
// discrete gradient (O. Gonzalez, J. Nonlinear Sci. 6, 1996): what it does in the sub-step is k (x^2 - x'^2) / 2 to
// rounding, at any h, less k beta (x' - x)^2 / 2, and it exerts no couple. beta is 0 where the sub-step resolves the
// spring and 1 where it does not. (1 + beta) / 2 of F come before the bodies move.
//
// Newton's method for the lengths; its linear systems, (1 + h R A R) y = R^-1 (what the impulses lack) with R^2 the
// impulse per length and A how the bodies answer, are positive and are solved by conjugate gradients, prepared by each
// spring's own block. They conserve both momenta however far they came; what is left open net_settle accounts for.
#include "net_rows.inl"
#include "free_rotation.inl"

// One body as it would stand at the end of the sub-step.
PC_FN void pc_net_foresee(PC_IO Slot b, Index row) {
  Quad turned = PC_GATHER(pose, row, 1u);
  Quad moments = PC_GATHER(mass, row, 1u);
  Real h = PC_INFO(h);
  Vec3 v = pc_madd(pc_ld3_net(PC_PASS b, NET_VELOCITY), pc_ld3_net(PC_PASS b, NET_PUSH), PC_LD(net_rows, b, NET_MASS));
  Vec3 l = pc_add(pc_ld3_net(PC_PASS b, NET_MOMENTUM), pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
  Quaternion q = pc_quaternion(turned.v, turned.s);
  Quaternion turn = pc_quaternion_mul(pc_free_rotation(q, l, moments, h), pc_conjugate(q));
  precise Real w = turn.w + PC_REAL(1.0);
  pc_st3_net(PC_PASS b, NET_STEP, pc_scale(v, h));
  pc_st3_net(PC_PASS b, NET_TURN, turn.v);
  PC_ST(net_rows, b, NET_TURN + 3u, w);
}
// What a spring does across itself is solved for where this share of its bodies' own inertia feels it.
#define PC_FELT PC_REAL(1e-3)

// How far the end of an arm goes against its centre.
PC_FN Vec3 pc_net_swing(PC_IO Slot b, Vec3 arm) {
  return pc_swing_closely(pc_quaternion(pc_ld3_net(PC_PASS b, NET_TURN), PC_LD(net_rows, b, NET_TURN + 3u)), arm);
}
PC_FN Vec3 pc_net_root(PC_IO Slot s, Vec3 v) {
  Vec3 axis = pc_ld3_net(PC_PASS s, NET_AXIS);
  Real across = PC_LD(net_rows, s, NET_ACROSS);
  precise Real more = (PC_LD(net_rows, s, NET_ALONG) - across) * pc_dot(axis, v);
  return pc_madd(pc_scale(v, across), axis, more);
}
// A spring at the foreseen length: the impulse that it wants along n, the roots of its derivative along n and across
// it, and its part in what the solve lowers (Merit).
struct Pull {
  Vec3 n;
  Vec3 axis;
  Real wanted;
  Real along;
  Real across;
  Real level;
};
PC_FN Pull pc_net_pull(PC_IO Slot s, Slot a, Slot b, Vec3 then) {
  Real length = PC_LD(net_rows, s, NET_LENGTH);
  Real stiffness = PC_LD(net_rows, s, NET_STIFFNESS);
  Real damping = PC_LD(net_rows, s, NET_DAMPING);
  Real long_then = pc_length(then);
  precise Real both = length + long_then;
  Real inverse_both = pc_inverse_or_zero(both);
  precise Real share = PC_LD(net_rows, s, NET_LATE) * PC_REAL(0.5) + PC_REAL(0.5);
  precise Real longer = long_then - length;
  precise Real away = (length - PC_LD(net_rows, s, NET_REST)) + share * longer;
  precise Real time = PC_INFO(h) * share;
  precise Real elastic = stiffness * away * time;
  precise Real viscous = damping * longer * share;
  precise Real wanted = -(elastic + viscous);
  precise Real along = time * stiffness * share + damping * share;
  precise Real pull = (elastic + viscous) * inverse_both;
  Real across = pc_clamp(pull, PC_REAL(0.0), along);
  precise Real free = (PC_LD(net_rows, a, NET_MASS) + PC_LD(net_rows, b, NET_MASS)) * PC_INFO(h);
  precise Real felt = across * free;
  precise Real gain = (length - PC_LD(net_rows, s, NET_REST)) + longer * share * PC_REAL(0.5);
  precise Real by_length = time * stiffness * gain * longer;
  precise Real by_rate = damping * share * longer * longer * PC_REAL(0.5);
  precise Real level = (by_length + by_rate) * PC_INFO(inverse_h);
  Pull p;
  p.n = pc_scale(pc_add(pc_ld3_net(PC_PASS s, NET_LINE), then), inverse_both);
  p.axis = pc_unit_or_zero(p.n);
  p.wanted = wanted;
  p.along = pc_sqrt(along);
  p.across = pc_select(felt > PC_FELT, pc_sqrt(across), PC_REAL(0.0));
  p.level = level;
  PC_ST(net_rows, s, NET_THEN, long_then);
  return p;
}
// What the impulse lacks of what the spring wants: along its axis and across it by what their roots make of it, and
// across where that is not solved for, whole.
PC_FN void pc_net_keep_lack(PC_IO Slot s, Pull p, Vec3 lack) {
  Real lack_along = pc_dot(p.axis, lack);
  Vec3 lack_across = pc_madd(lack, p.axis, -lack_along);
  precise Real y_along = lack_along * pc_inverse_or_zero(p.along);
  Vec3 y_across = pc_scale(lack_across, pc_inverse_or_zero(p.across));
  pc_st3_net(PC_PASS s, NET_AXIS, p.axis);
  PC_ST(net_rows, s, NET_ALONG, p.along);
  PC_ST(net_rows, s, NET_ACROSS, p.across);
  pc_st3_net(PC_PASS s, NET_LACK, pc_madd(y_across, p.axis, y_along));
  pc_st3_net(PC_PASS s, NET_TURNED, pc_select3(p.across > PC_REAL(0.0), pc_zero3(), lack_across));
}
// Its parts in what the solve is judged by (Merit).
PC_FN void pc_net_keep_merit(PC_IO Slot s, Real level, Vec3 lack, Vec3 impulse, Sym3 answer) {
  precise Real trace = answer.xx + answer.yy + answer.zz;
  precise Real open = pc_dot(lack, lack) * trace;
  precise Real given = pc_dot(impulse, impulse) * trace;
  PC_ST(net_rows, s, NET_LEVEL, level);
  PC_ST(net_rows, s, NET_OPEN, open);
  PC_ST(net_rows, s, NET_GIVEN, given);
}
// The inverse of its own block 1 + h R A R, which prepares the search.
PC_FN void pc_net_keep_block(PC_IO Slot s, Sym3 answer) {
  Real h = PC_INFO(h);
  Real zero = PC_REAL(0.0);
  Vec3 x = pc_net_root(PC_PASS s, Vec3(PC_REAL(1.0), zero, zero));
  Vec3 y = pc_net_root(PC_PASS s, Vec3(zero, PC_REAL(1.0), zero));
  Vec3 z = pc_net_root(PC_PASS s, Vec3(zero, zero, PC_REAL(1.0)));
  Vec3 ax = pc_sym_mul(answer, x);
  Vec3 ay = pc_sym_mul(answer, y);
  Vec3 az = pc_sym_mul(answer, z);
  precise Real xx = pc_dot(x, ax) * h + PC_REAL(1.0);
  precise Real xy = pc_dot(x, ay) * h;
  precise Real xz = pc_dot(x, az) * h;
  precise Real yy = pc_dot(y, ay) * h + PC_REAL(1.0);
  precise Real yz = pc_dot(y, az) * h;
  precise Real zz = pc_dot(z, az) * h + PC_REAL(1.0);
  Sym3 block = pc_sym3(xx, xy, xz, yy, yz, zz);
  pc_sts_net(PC_PASS s, NET_BLOCK, pc_sym_inverse(block));
}
// What the impulse lacks at the foreseen length, its derivative, and what prepares the search.
// `taken`: share of the step that was found.
PC_FN void pc_net_look(PC_IO Slot s, Slot a, Slot b, Real taken) {
  Vec3 arm_a = pc_ld3_net(PC_PASS s, NET_START);
  Vec3 arm_b = pc_ld3_net(PC_PASS s, NET_START + 3u);
  Vec3 apart = pc_sub(pc_ld3_net(PC_PASS b, NET_STEP), pc_ld3_net(PC_PASS a, NET_STEP));
  Vec3 swing_a = pc_net_swing(PC_PASS a, arm_a);
  Vec3 swing_b = pc_net_swing(PC_PASS b, arm_b);
  Vec3 ra = pc_madd(arm_a, swing_a, PC_REAL(0.5));
  Vec3 rb = pc_madd(arm_b, swing_b, PC_REAL(0.5));
  pc_st3_net(PC_PASS s, NET_MID, ra);
  pc_st3_net(PC_PASS s, NET_MID + 3u, rb);
  Vec3 then = pc_add(pc_ld3_net(PC_PASS s, NET_LINE), pc_add(apart, pc_sub(swing_b, swing_a)));
  Pull p = pc_net_pull(PC_PASS s, a, b, then);
  Vec3 impulse = pc_net_further(pc_ld3_net(PC_PASS s, NET_IMPULSE), pc_ld3_net(PC_PASS s, NET_FOUND), taken);
  Vec3 lack = pc_sub(pc_scale(p.n, p.wanted), impulse);
  Sym3 answer = pc_net_answer(PC_PASS a, b, ra, rb);
  pc_net_keep_lack(PC_PASS s, p, lack);
  pc_net_keep_merit(PC_PASS s, p.level, lack, impulse, answer);
  pc_net_keep_block(PC_PASS s, answer);
}
// Impulses and arms with a share of the step that was found, and what they make of the bodies, where `live`.
PC_FN void pc_net_try(PC_IO Slot m, Net n, Real share, Mask live) {
  pc_net_clear(PC_PASS m, n, NET_SUM);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 impulse = pc_net_further(pc_ld3_net(PC_PASS s, NET_IMPULSE), pc_ld3_net(PC_PASS s, NET_FOUND), share);
    Vec3 ra = pc_ld3_net(PC_PASS s, NET_ARM_A);
    Vec3 rb = pc_ld3_net(PC_PASS s, NET_ARM_B);
    Vec3 arm_a = pc_net_further(ra, pc_sub(pc_ld3_net(PC_PASS s, NET_AIM), ra), share);
    Vec3 arm_b = pc_net_further(rb, pc_sub(pc_ld3_net(PC_PASS s, NET_AIM + 3u), rb), share);
    Slot a = pc_net_end(PC_PASS m, n, k, 0u);
    pc_net_add(PC_PASS a, pc_net_end(PC_PASS m, n, k, 1u), NET_SUM, arm_a, arm_b, impulse);
  }
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    pc_net_keep(PC_PASS b, NET_PUSH, live, pc_ld3_net(PC_PASS b, NET_SUM));
    pc_net_keep(PC_PASS b, NET_PUSH + 3u, live, pc_ld3_net(PC_PASS b, NET_SUM + 3u));
  }
}
// Takes that share, where `takes`.
PC_FN void pc_net_take(PC_IO Slot m, Net n, Real share, Mask takes) {
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 ra = pc_ld3_net(PC_PASS s, NET_ARM_A);
    Vec3 rb = pc_ld3_net(PC_PASS s, NET_ARM_B);
    Vec3 aim_a = pc_ld3_net(PC_PASS s, NET_AIM);
    Vec3 aim_b = pc_ld3_net(PC_PASS s, NET_AIM + 3u);
    Vec3 impulse = pc_ld3_net(PC_PASS s, NET_IMPULSE);
    Vec3 taken = pc_net_further(impulse, pc_ld3_net(PC_PASS s, NET_FOUND), share);
    pc_st3_net(PC_PASS s, NET_IMPULSE, pc_select3(takes, taken, impulse));
    pc_st3_net(PC_PASS s, NET_ARM_A, pc_select3(takes, pc_net_further(ra, pc_sub(aim_a, ra), share), ra));
    pc_st3_net(PC_PASS s, NET_ARM_B, pc_select3(takes, pc_net_further(rb, pc_sub(aim_b, rb), share), rb));
    pc_st3_net(PC_PASS s, NET_AIM, pc_select3(takes, pc_ld3_net(PC_PASS s, NET_MID), aim_a));
    pc_st3_net(PC_PASS s, NET_AIM + 3u, pc_select3(takes, pc_ld3_net(PC_PASS s, NET_MID + 3u), aim_b));
  }
}

#include "net_search.inl"

PC_FN void pc_net_begin(PC_IO Slot m, Net n, Mask asked) {
  Mask fresh = pc_and(asked, PC_LD(net_rows, pc_net_body(PC_PASS m, n, 0u), NET_FRESH) > PC_REAL(0.5));
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Index row = pc_net_row(PC_PASS m, n, k);
    Quad linear = PC_GATHER(motion, row, 0u);
    Quad angular = PC_GATHER(motion, row, 1u);
    Quad turned = PC_GATHER(pose, row, 1u);
    Sym3 inverse = pc_world_inertia(pc_quaternion(turned.v, turned.s), PC_GATHER(mass, row, 1u).v);
    Vec3 push = pc_ld3_net(PC_PASS b, NET_PUSH);
    Vec3 l = pc_sub(angular.v, pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
    pc_st3_net(PC_PASS b, NET_PUSHED, push);
    pc_st3_net(PC_PASS b, NET_PUSHED + 3u, pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
    pc_net_keep(PC_PASS b, NET_VELOCITY, asked, pc_madd(linear.v, push, -linear.s));
    pc_net_keep(PC_PASS b, NET_MOMENTUM, asked, l);
    pc_net_keep(PC_PASS b, NET_SPIN, asked, pc_sym_mul(inverse, l));
    pc_net_keep(PC_PASS b, NET_FIRST, fresh, pc_ld3_net(PC_PASS b, NET_VELOCITY));
    pc_net_keep(PC_PASS b, NET_FIRST_SPIN, fresh, pc_ld3_net(PC_PASS b, NET_SPIN));
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_st3_net(PC_PASS s, NET_FOUND, pc_zero3());
    pc_st3_net(PC_PASS s, NET_AIM, pc_ld3_net(PC_PASS s, NET_ARM_A));
    pc_st3_net(PC_PASS s, NET_AIM + 3u, pc_ld3_net(PC_PASS s, NET_ARM_B));
  }
}
// What the first halves do to a body's energy: their momenta times the means of the velocities before all of them and
// after, with what contacts did in between (what only presses on something does no work); of one that moves as it is
// told what it took from the springs.
PC_FN Real pc_net_count(PC_IO Slot b) {
  Vec3 push = pc_ld3_net(PC_PASS b, NET_PUSH);
  Vec3 turn = pc_ld3_net(PC_PASS b, NET_PUSH + 3u);
  Vec3 both = pc_add(pc_ld3_net(PC_PASS b, NET_FIRST), pc_ld3_net(PC_PASS b, NET_VELOCITY));
  Vec3 both_spin = pc_add(pc_ld3_net(PC_PASS b, NET_FIRST_SPIN), pc_ld3_net(PC_PASS b, NET_SPIN));
  Vec3 v = pc_madd(both, push, PC_LD(net_rows, b, NET_MASS));
  Vec3 w = pc_add(both_spin, pc_sym_mul(pc_lds_net(PC_PASS b, NET_INERTIA), turn));
  precise Real work = (pc_dot(push, v) + pc_dot(turn, w)) * PC_REAL(0.5);
  return work;
}

// What the solve lowers: the energy of what the impulses change, and what the springs will have been stretched by; with
// it the square of what the impulses lack, and of the impulses themselves, in the same unit.
struct Merit {
  Real level;
  Real open;
  Real given;
};
PC_FN Merit pc_net_merit(PC_IO Slot m, Net n, Real share) {
  Merit all;
  all.level = PC_REAL(0.0);
  all.open = PC_REAL(0.0);
  all.given = PC_REAL(0.0);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    pc_net_foresee(PC_PASS b, pc_net_row(PC_PASS m, n, k));
    Vec3 push = pc_ld3_net(PC_PASS b, NET_PUSH);
    Vec3 turn = pc_ld3_net(PC_PASS b, NET_PUSH + 3u);
    Vec3 spin = pc_sym_mul(pc_lds_net(PC_PASS b, NET_INERTIA), turn);
    precise Real twice = pc_dot(push, push) * PC_LD(net_rows, b, NET_MASS) + pc_dot(turn, spin);
    precise Real sum = all.level + twice * PC_REAL(0.5);
    all.level = sum;
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_net_look(PC_PASS s, pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u), share);
    precise Real level = all.level + PC_LD(net_rows, s, NET_LEVEL);
    precise Real open = all.open + PC_LD(net_rows, s, NET_OPEN);
    precise Real given = all.given + PC_LD(net_rows, s, NET_GIVEN);
    all.level = level;
    all.open = open;
    all.given = given;
  }
  return all;
}
#include "net_bound.inl"

// Where there is something to solve: the first time in a sub-step, and where others have changed what it left.
// Otherwise what happens in other islands would decide whether a net is solved once more.
PC_FN Mask pc_net_wants(PC_IO Slot m, Net n) {
  Mask wants = PC_LD(net_rows, pc_net_body(PC_PASS m, n, 0u), NET_FRESH) > PC_REAL(0.5);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Index row = pc_net_row(PC_PASS m, n, k);
    Quad linear = PC_GATHER(motion, row, 0u);
    Vec3 v = pc_madd(pc_ld3_net(PC_PASS b, NET_VELOCITY), pc_ld3_net(PC_PASS b, NET_PUSH), linear.s);
    Vec3 l = pc_add(pc_ld3_net(PC_PASS b, NET_MOMENTUM), pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
    Vec3 dv = pc_sub(linear.v, v);
    Vec3 dl = pc_sub(PC_GATHER(motion, row, 1u).v, l);
    Mask moved = pc_or(pc_nonzero(dv.x), pc_or(pc_nonzero(dv.y), pc_nonzero(dv.z)));
    Mask turned = pc_or(pc_nonzero(dl.x), pc_or(pc_nonzero(dl.y), pc_nonzero(dl.z)));
    wants = pc_or(wants, pc_and(linear.s > PC_REAL(0.0), pc_or(moved, turned)));
  }
  return wants;
}

// Gives the bodies of nets that are `asked` what their springs push; of others nothing changes.
PC_FN void pc_net_end_solve(PC_IO Slot m, Net n, Mask asked) {
  PC_ST(net_rows, pc_net_body(PC_PASS m, n, 0u), NET_FRESH, PC_REAL(0.0));
  Mask kept = pc_select(asked, PC_REAL(0.0), PC_REAL(1.0)) > PC_REAL(0.5);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Index row = pc_net_row(PC_PASS m, n, k);
    Quad linear = PC_GATHER(motion, row, 0u);
    Quad angular = PC_GATHER(motion, row, 1u);
    Mask moves = pc_and(asked, linear.s > PC_REAL(0.0));
    pc_net_keep(PC_PASS b, NET_PUSH, kept, pc_ld3_net(PC_PASS b, NET_PUSHED));
    pc_net_keep(PC_PASS b, NET_PUSH + 3u, kept, pc_ld3_net(PC_PASS b, NET_PUSHED + 3u));
    PC_ST(net_rows, b, NET_MADE, pc_select(asked, pc_net_count(PC_PASS b), PC_LD(net_rows, b, NET_MADE)));
    linear.v = pc_madd(pc_ld3_net(PC_PASS b, NET_VELOCITY), pc_ld3_net(PC_PASS b, NET_PUSH), linear.s);
    Vec3 l = pc_add(pc_ld3_net(PC_PASS b, NET_MOMENTUM), pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
    PC_SCATTER_IF(moves, motion, row, 0u, linear);
    PC_SCATTER_IF(moves, motion, row, 1u, pc_quad(l, angular.s));
  }
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Net n = pc_net(PC_PASS m);
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  Mask asked = pc_net_wants(PC_PASS m, n);
  if (!PC_ANY(asked)) return;  // lint: allow (nothing is stored otherwise)
  pc_net_begin(PC_PASS m, n, asked);
  // what moved as one body is solved for anew
  Slot keeper = pc_net_body(PC_PASS m, n, 0u);
  Mask rigid = pc_and(asked, PC_LD(net_rows, keeper, NET_BOUND) > zero);
  if (PC_ANY(rigid)) pc_net_try(PC_PASS m, n, zero, rigid);  // lint: allow (others keep what they have)
  PC_ST(net_rows, keeper, NET_BOUND, pc_select(rigid, zero, PC_LD(net_rows, keeper, NET_BOUND)));
  Mask live = asked;  // a net that is done stays as it is, where nets beside it go on
  uint rounds = PC_COUNT(rounds);
  Real share = zero;
  Real level = zero;
  Mask bent = zero > one;
  for (uint i = 0u; i < rounds; i++) {
    Merit now = pc_net_merit(PC_PASS m, n, share);
    Mask first = pc_select(PC_IS(i), zero, one) > PC_REAL(0.5);
    precise Real bound = level + pc_abs(level) * PC_INFO(rounding);
    Mask better = pc_or(pc_or(first, share < PC_TINY), now.level < bound);
    level = pc_select(better, now.level, level);
    pc_net_take(PC_PASS m, n, share, pc_and(live, better));
    precise Real enough = now.given * (PC_INFO(rounding) * PC_INFO(rounding));
    Mask goes = pc_and(live, pc_and(better, now.open > enough));
    Mask back = pc_and(live, pc_select(better, zero, one) > PC_REAL(0.5));
    // what led up is sought anew from where it was, by the other form; that only in smaller steps
    Real kept_bent = pc_select(bent, pc_select(pc_and(better, share > zero), zero, one), zero);
    Mask anew = pc_and(back, kept_bent < PC_REAL(0.5));
    bent = pc_select(anew, one, kept_bent) > PC_REAL(0.5);
    share = pc_select(pc_or(better, anew), zero, share);
    live = pc_or(goes, back);
    if (!PC_ANY(live)) break;  // lint: allow (nothing more is found)
    if (i + 1u < rounds) pc_net_search(PC_PASS m, n, goes, bent);
    uint left = rounds - 1u - i;
    // a step that led up is made a quarter of it; the last one that may be is not taken
    Real less = pc_select(PC_IS(left), pc_quarter(PC_REAL(1.0)), zero);
    precise Real kept = share * less;
    share = pc_select(back, kept, pc_select(goes, pc_select(PC_IS(left), one, zero), zero));
    pc_net_try(PC_PASS m, n, share, live);
  }
  pc_net_bound(PC_PASS m, n, asked);
  pc_net_even(PC_PASS m, n, asked);
  pc_net_end_solve(PC_PASS m, n, asked);
}
