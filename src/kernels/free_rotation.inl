// Free rotation of a rigid body over a sub-step.
// Rotation under constant world angular momentum L, by splitting the free rigid body
//   H = |L|^2 / (2 I_m) + (1/I_a - 1/I_m) Pi_a^2 / 2 + (1/I_c - 1/I_m) Pi_c^2 / 2,   Pi = q* L,
// with m the axis of the middle moment: the first term is one world rotation about L and commutes with the
// rest; the other two are rotations about body axes, c about that of the smallest moment. They are composed in fourth
// order where both turn by more than PC_FINE_TURN, and below, where no more than rounding is to be had, as half a, c,
// half a (Strang). L is exact. Two equal moments: the middle one is among them, one term vanishes and the motion is
// exact; three equal moments: one rotation. (McLachlan and Quispel, Splitting methods, Acta Numerica 11, 2002,
// section 3.)
// A body that turns against its middle axis by more than a radian does so in up to 16 such parts: the splitting alone
// keeps |L| but finds other axes there, and a box gained half its energy. Beyond 8 radians, where a pose no longer
// tells how far it turned, it moves along its polhode as if it were 8. What a turn of more than PC_KEPT_TURN is off in
// energy is turned back. Of smaller ones the energy only oscillates, by parts in 1e9 (single: 1e6), and to turn
// roundings back would be a drift.

// The squares of these angles: 1e-5 and 0.02 rad, and 1.4e-3 and 0.1 in single precision; and what counts as rounding.
#ifdef PC_DOUBLE
#define PC_FINE_TURN PC_REAL(1e-10)
#define PC_KEPT_TURN PC_REAL(4e-4)
#define PC_ENERGY_ROUNDING PC_REAL(1e-15)
#else
#define PC_FINE_TURN PC_REAL(2e-6)
#define PC_KEPT_TURN PC_REAL(1e-2)
#define PC_ENERGY_ROUNDING PC_REAL(2e-7)
#endif
// Of a fast turn, how far it is told [rad], and in how many parts it is made at most.
#define PC_FASTEST_TURN PC_REAL(8.0)
#define PC_MOST_PARTS PC_REAL(16.0)
// Shares of the fourth-order composition (pc_composed_turns), in the names of its authors,
// and how many pairs of turns it has.
#define PC_FINE_XI PC_REAL(0.1786178958448091)
#define PC_FINE_CHI PC_REAL(-0.06626458266981849)
#define PC_FINE_LAMBDA PC_REAL(-0.2123418310626054)
#define PC_FINE_PAIRS PC_REAL(5.0)
// The square of the sine between spin and momentum below which turning the body changes no energy.
#define PC_ALONG_AXIS PC_REAL(1e-12)

// What a sub-step changes in an orientation q: W q B - q = (W - 1) (q B) + q (B - 1).
PC_FN Quaternion pc_change(Turn world, Quaternion q, Turn body) {
  Quaternion inner = pc_quaternion_mul(q, pc_quaternion(body.q.v, body.fall));
  precise Vec3 v = q.v + inner.v;
  precise Real w = q.w + inner.w;
  Quaternion outer = pc_quaternion_mul(pc_quaternion(world.q.v, world.fall), pc_quaternion(v, w));
  precise Vec3 both_v = inner.v + outer.v;
  precise Real both_w = inner.w + outer.w;
  return pc_quaternion(both_v, both_w);
}

struct Spin {
  Turn turn;
  Vec3 pi;
};
PC_FN Turn pc_turn_select(Mask m, Turn a, Turn b) {
  Turn r;
  r.q.v = pc_select3(m, a.q.v, b.q.v);
  r.q.w = pc_select(m, a.q.w, b.q.w);
  r.fall = pc_select(m, a.fall, b.fall);
  return r;
}
PC_FN Spin pc_spin_select(Mask m, Spin a, Spin b) {
  Spin r;
  r.turn = pc_turn_select(m, a.turn, b.turn);
  r.pi = pc_select3(m, a.pi, b.pi);
  return r;
}
// Turns the body by rate * time * (its momentum along `axis`) about its own axis: appends to the turn, and Pi follows.
// Of two equal moments one is the middle one, and about the other's axis nothing turns.
PC_FN Spin pc_body_turn(Spin s, Vec3 axis, Real rate, Real time) {
  precise Real angle = pc_dot(axis, s.pi) * rate * time;
  Mask turns = pc_nonzero(angle);
  if (!PC_ANY(turns)) return s;  // lint: allow (other lanes keep what they have)
  Turn r = pc_axis_turn(axis, angle);
  Spin o;
  o.turn = pc_turn_mul(s.turn, r);
  o.pi = pc_rotate(pc_conjugate(r.q), s.pi);
  return pc_spin_select(turns, o, s);
}

// How many equal parts of less than half a radian each a fast turn is made of, 16 at most.
PC_FN Real pc_parts(Real angle) {
  precise Real wanted = pc_min(angle, PC_FASTEST_TURN) * PC_REAL(2.0) + PC_REAL(0.5);
  return pc_min(pc_round(wanted), PC_MOST_PARTS);
}
// The turns about a and c, one after the other. Where `fine`, in fourth order, five about a and four about c (I.
// Omelyan, I. Mryglod and R. Folk, Computer Physics Communications 146, 2002, 188: the position extended
// Forest-Ruth-like one), 1/26 of the error of the shortest such composition; else `pairs` of a turn about each: half of
// `time` about a, all of it or none about c. One pair is what c alone needs.
PC_FN Spin pc_composed_turns(Spin start, Vec3 a, Vec3 c, Real rate_a, Real rate_c, Real half_h, Real h, Mask fine,
                             Real pairs, Real time) {
  precise Real a1 = h * PC_FINE_XI;
  precise Real a2 = h * PC_FINE_CHI;
  precise Real a3 = h - (a1 + a2) * PC_REAL(2.0);
  precise Real c2 = h * PC_FINE_LAMBDA;
  precise Real c1 = half_h - c2;
  precise Real half_time = time * PC_REAL(0.5);
  Real zero = PC_REAL(0.0);
  Real left = pc_select(fine, PC_FINE_PAIRS, pairs);
  Spin s = start;
  for (uint i = 0u; i < 32u; i++) {
    if (!PC_ANY(left > PC_REAL(0.5))) break;  // lint: allow (nothing turns any more)
    Real fine_a = a2;
    Real fine_c = zero;
    Real plain_c = zero;
    if (i == 0u || i == 4u) fine_a = a1;
    if (i == 2u) fine_a = a3;
    if (i == 0u || i == 3u) fine_c = c1;
    if (i == 1u || i == 2u) fine_c = c2;
    if ((i & 1u) == 0u) plain_c = time;
    Mask on = left > PC_REAL(0.5);
    s = pc_body_turn(s, a, rate_a, pc_select(on, pc_select(fine, fine_a, half_time), zero));
    s = pc_body_turn(s, c, rate_c, pc_select(on, pc_select(fine, fine_c, plain_c), zero));
    precise Real rest = left - PC_REAL(1.0);
    left = rest;
  }
  return s;
}
PC_FN Vec3 pc_times(Vec3 a, Vec3 b) {
  precise Real x = a.x * b.x;
  precise Real y = a.y * b.y;
  precise Real z = a.z * b.z;
  return Vec3(x, y, z);
}
// The direction of the momentum `before` as the body sees it after a turn: by one rotation, since a slender body's
// energy has what many add up to in rounding by the ratio of its moments.
PC_FN Vec3 pc_seen(Turn turn, Vec3 before) { return pc_unit_or_zero(pc_rotate(pc_conjugate(turn.q), before)); }
// Turns the body by what brings its energy back to that of the momentum `before`, the shortest way: along Pi x w, of
// which the energy falls by its square. Newton's method, by half a radian at most at a time, where it is off by more
// than rounding. In units of the momentum and the sub-step.
PC_FN Turn pc_keep_energy(Turn turn, Vec3 inverse, Vec3 before, Real h, Mask these) {
  precise Real unit = pc_length(before) * h;
  Vec3 rates = pc_scale(inverse, unit);
  Vec3 start = pc_unit_or_zero(before);
  Real wanted = pc_dot(start, pc_times(start, rates));
  precise Real rounding = wanted * PC_ENERGY_ROUNDING;
  Turn kept = turn;
  // (not left before its end: NVIDIA's compiler then rounds otherwise)
  for (uint i = 0u; i < 5u; i++) {
    Vec3 pi = pc_seen(kept, start);
    Vec3 w = pc_times(pi, rates);
    precise Real excess = (pc_dot(pi, w) - wanted) * PC_REAL(0.5);
    Mask off = pc_and(these, pc_abs(excess) > rounding);
    Vec3 way = pc_cross(pi, w);
    Real square = pc_dot(way, way);
    Real step = pc_div(excess, pc_max(square, PC_ALONG_AXIS));
    precise Real length = pc_sqrt(square) * step;
    Real most = pc_max(pc_abs(length), PC_REAL(0.5));
    precise Real part = step * PC_REAL(0.5);
    kept = pc_turn_select(off, pc_turn_mul(kept, pc_turn(pc_scale(way, pc_div(part, most)))), kept);
  }
  return kept;
}

PC_FN Quaternion pc_free_rotation(Quaternion q, Vec3 l, Quad moments, Real h) {
  Vec3 inverse = moments.v;
  Mask first = moments.s < PC_REAL(0.5);
  Mask last = moments.s > PC_REAL(1.0);
  Vec3 x = Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0));
  Vec3 y = Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  Vec3 z = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(1.0));
  Vec3 before = pc_select3(first, y, x);
  Vec3 behind = pc_select3(last, y, z);
  Mask lighter = pc_dot(before, inverse) > pc_dot(behind, inverse);
  Vec3 a = pc_select3(lighter, behind, before);
  Vec3 c = pc_select3(lighter, before, behind);
  Real im = pc_select(first, inverse.x, pc_select(last, inverse.z, inverse.y));
  precise Real rate_a = pc_dot(a, inverse) - im;
  precise Real rate_c = pc_dot(c, inverse) - im;
  precise Real half_h = h * PC_REAL(0.5);
  Spin start;
  start.turn.q = pc_quaternion(pc_zero3(), PC_REAL(1.0));
  start.turn.fall = PC_REAL(0.0);
  start.pi = pc_rotate(pc_conjugate(q), l);
  precise Real world_time = im * h;
  Turn world = pc_turn(pc_scale(l, world_time));
  Mask splits = pc_and(pc_abs(rate_a) > PC_REAL(0.0), pc_abs(rate_c) > PC_REAL(0.0));  // where not, the motion is exact
  Mask fine = PC_IS(0u);
  Mask kept = fine;
  Real pairs = pc_select(pc_abs(rate_a) > PC_REAL(0.0), PC_REAL(2.0), PC_REAL(1.0));
  Real time = h;
  if (PC_ANY(splits)) {  // lint: allow (what the rest makes of others)
    // how far the two turns go, squared (twice the energy bounds each momentum: Pi_c^2 <= 2 E I_c)
    precise Real twice = pc_dot(start.pi, pc_times(start.pi, inverse)) * h * h;
    precise Real square_a = twice * rate_a * rate_a;
    precise Real square_c = twice * rate_c * rate_c;
    Real inverse_a = pc_dot(a, inverse);
    Real inverse_c = pc_dot(c, inverse);
    Mask fast = pc_and(pc_or(square_a > inverse_a, square_c > inverse_c), splits);
    precise Real least_a = inverse_a * PC_FINE_TURN;
    precise Real least_c = inverse_c * PC_FINE_TURN;
    Mask turns = pc_and(square_a > least_a, square_c > least_c);
    fine = pc_select(fast, PC_REAL(0.0), pc_select(turns, PC_REAL(1.0), PC_REAL(0.0))) > PC_REAL(0.5);
    if (PC_ANY(fast)) {  // lint: allow (other lanes keep what they have)
      precise Real a2 = square_a * pc_inverse_or_zero(inverse_a);
      precise Real c2 = square_c * pc_inverse_or_zero(inverse_c);
      Real angle = pc_sqrt(pc_max(a2, c2));
      precise Real span = h * pc_div(PC_FASTEST_TURN, pc_max(angle, PC_FASTEST_TURN));
      Real parts = pc_parts(angle);
      precise Real all = parts + parts;
      pairs = pc_select(fast, all, pairs);
      time = pc_select(fast, pc_div(span, parts), time);
    }
    precise Real kept_a = inverse_a * PC_KEPT_TURN;
    precise Real kept_c = inverse_c * PC_KEPT_TURN;
    kept = pc_and(splits, pc_or(square_a > kept_a, square_c > kept_c));
  }
  Spin s = pc_composed_turns(start, a, c, rate_a, rate_c, half_h, h, fine, pairs, time);
  Turn turn = s.turn;
  if (PC_ANY(kept)) {  // lint: allow (other lanes keep what they have)
    turn = pc_keep_energy(turn, inverse, start.pi, h, kept);
  }
  return pc_change(world, q, turn);
}
