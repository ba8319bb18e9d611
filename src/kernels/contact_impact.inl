// Impacts, at the instant at which they happen. A row whose gap closes within this sub-step closes at the time t of
//   s + v t + A t^2 / 2 = 0,   v = u - A h / 2,   v* = v + A t,
// with u the stored velocity, half a sub-step behind, and A the acceleration between impulses. The impulse J turns v*
// into -e v* there, with friction by Coulomb's law, at the arms of that instant. As seen from the end of the sub-step
// it changed the velocity by J / m and the position by (h - t) J / m: so J acts on u whole and the position goes
// back by t J / m. For a single contact that is exact, energy and all; several follow one another.
// The rows of one manifold that close are solved together. What is left (slow approaches, several impacts of one body
// in one sub-step that block each other) is contact_solve's, what is on joints tree_contact_solve's; but shapes that
// meet in flight, whose arms mean nothing before they do, are left to this kernel for the whole step.
#define PC_SOME_ROWS
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_masses.inl"
#include "contact_shift.inl"
#include "row_approach.inl"
#include "free_responses.inl"
#include "contact_coulomb.inl"
#include "contact_together.inl"
#include "contact_turned.inl"
#include "contact_calming.inl"
#include "contact_blow.inl"

// u_aim: the velocity u that the row is to leave with; closes: 1 or 0
struct Closing {
  Real t;
  Real u;
  Real u_aim;
  Real closes;
};
PC_FN Closing pc_closing(PC_IO Real u, Real s, Real acceleration, Real mass, Real e, Mask always) {
  Real h = PC_INFO(h);
  Real zero = PC_REAL(0.0);
  precise Real half_change = acceleration * h * PC_REAL(0.5);
  precise Real v = u - half_change;
  precise Real square = v * v - acceleration * s * PC_REAL(2.0);
  Mask open = s > zero;
  Mask meets = pc_and(open, square > zero);
  Real root = pc_sqrt(pc_select(meets, square, zero));
  precise Real nearer = root - v;
  meets = pc_and(meets, nearer > zero);
  precise Real twice = s * PC_REAL(2.0);
  Real t = pc_select(meets, pc_div(twice, pc_select(meets, nearer, PC_REAL(1.0))), zero);
  Real impact = pc_select(open, -root, v);
  // what rests approaches with what the forces give it in a sub-step
  precise Real slow = PC_INFO(restitution_threshold) + pc_abs(acceleration) * h;
  Mask fast = impact < -slow;
  // beyond rounding: what closes no row of this sub-step would be stopped by the solver
  precise Real most = h * PC_SURELY;
  // what overlaps stops where it is: its push would be speed that nothing takes back
  Real ahead = pc_select(open, pc_select(meets, t, most), pc_select(v < zero, zero, most));
  Mask now = ahead < most;
  now = pc_and(pc_and(now, mass > zero), pc_or(pc_and(fast, e > zero), pc_and(always, impact < zero)));
  Real bounce = pc_select(fast, e, zero);
  precise Real thrown = -bounce * impact;
  precise Real falls = half_change - acceleration * t + pc_max(thrown, zero);
  // what touches already is held: else it would sink by what it falls in each sub-step, and no impact pushes it out
  Real aim = pc_select(open, falls, pc_max(falls, zero));
  Closing r;
  r.t = t;
  r.u = u;
  r.u_aim = aim;
  r.closes = pc_select(now, PC_REAL(1.0), zero);
  return r;
}
// What a row asks for, as a change of its impulse, where its velocity is u by now.
PC_FN Real pc_impact_row(Real u, Closing c, Real mass) {
  precise Real change = mass * (c.u_aim - u) * c.closes;
  return change;
}

// Acceleration between impulses, of the centre and of the turning.
struct Acceleration {
  Vec3 a;
  Vec3 turn;
};
PC_FN Acceleration pc_acceleration(PC_IO Index i, BodyState b) {
  Quad push = PC_GATHER(force, i, 0u);
  Quad turn = PC_GATHER(force, i, 1u);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Acceleration r;
  r.a = pc_select3(b.inverse_mass > PC_REAL(0.0), pc_madd(gravity, push.v, b.inverse_mass), pc_zero3());
  precise Real response = b.response;
  r.turn = pc_scale(pc_sym_mul(b.inertia, turn.v), response);
  return r;
}

PC_FN void pc_shift_place(PC_IO Index i, Mask these, Vec3 shift) {
  Quad place = PC_GATHER(pose, i, 0u);
  Quad low = PC_GATHER(pose, i, 2u);
  Quad moved = PC_GATHER(delta, i, 0u);
  TwoSum p = pc_two_sum(place.v, pc_add(low.v, shift));
  PC_SCATTER_IF(these, pose, i, 0u, pc_quad(p.sum, place.s));
  PC_SCATTER_IF(these, pose, i, 2u, pc_quad(pc_snap3(p.low), low.s));
  PC_SCATTER_IF(these, delta, i, 0u, pc_quad(pc_add(moved.v, shift), moved.s));
}

// The body goes back by what the impulse moves it before the impact; the impulse is no force (see synchronise).
PC_FN void pc_set_back(PC_IO Index i, BodyState before, BodyState after, Real t, Mask hits) {
  Mask moves = pc_and(hits, after.inverse_mass > PC_REAL(0.0));
  Vec3 dv = pc_sub(after.v, before.v);
  Vec3 dl = pc_sub(after.l, before.l);
  precise Real back = -t;
  Quad hit = PC_GATHER(delta, i, 2u);
  PC_SCATTER_IF(moves, delta, i, 2u, pc_quad(Vec3(pc_max(hit.v.x, pc_max(t, PC_TINY)), hit.v.y, hit.v.z), hit.s));
  pc_shift_place(PC_PASS i, moves, pc_scale(dv, back));
  Quad turned = PC_GATHER(delta, i, 1u);
  precise Real struck = turned.s + PC_REAL(1.0);
  PC_SCATTER_IF(moves, delta, i, 1u, pc_quad(turned.v, struck));
  pc_count_blow(PC_PASS i, moves, dv, dl);
}

// What has bounced does not bounce again at the end of the step: its place holds the impulse (contact_touch) in place
// of the approach.
PC_FN void pc_keep_impact(PC_IO Slot m, uint i, Real impulse, Real share) {
  Real before = PC_LD(contact_rows, m, ROW_APPROACH + i);
  precise Real all = pc_max(before, PC_REAL(0.0)) + impulse * share;
  PC_ST(contact_rows, m, ROW_APPROACH + i, pc_select(impulse > PC_REAL(0.0), all, before));
}

// Whose impacts are looked for: 1 where they bounce or meet in flight.
PC_FN Mask pc_impact_always(PC_IO Slot m) { return PC_LD(contact_rows, m, ROW_IMPACT) > PC_REAL(0.0); }
PC_FN Mask pc_impact_mine(PC_IO Slot m) {
  Mask bounces = PC_LD(contact_rows, m, ROW_E) > PC_REAL(0.0);
  return pc_and(PC_LD(contact_rows, m, ROW_IMPACT) > PC_REAL(-0.5), pc_or(pc_impact_always(PC_PASS m), bounces));
}

// An approach up to this share of the speeds of both and of their surfaces is none. Shapes have met within a millionth
// of their thickness, or what rounding leaves of the way, so the arms of that instant are off by as much, and with them
// what the impulse leaves.
#define PC_IMPACT_NOISE PC_REAL(3e-5)
PC_FN Real pc_noise(PC_IO Slot m, BodyState a, BodyState b) {
  Vec3 relative = pc_sub(b.v, a.v);
  precise Real surface_a = pc_length(pc_angular_velocity(a)) * pc_length(pc_ld3_rows(PC_PASS m, ROW_ARM_A));
  precise Real surface_b = pc_length(pc_angular_velocity(b)) * pc_length(pc_ld3_rows(PC_PASS m, ROW_ARM_B));
  precise Real r = PC_IMPACT_NOISE * (pc_length(relative) + surface_a + surface_b);
  return r;
}

// The way to the arms at impact: when the centres have come as near as the narrowest gap is wide. (Arms that are not
// those of the way that was really gone would answer otherwise than masses say, and make energy.) Two that have met,
// and that nothing has brought together again since, are seen at that instant: at an earlier or later one the point of
// their impact has moved on with one and not with the other, and their spins would look like an approach.
PC_FN Vec3 pc_impact_path(PC_IO Slot m, Vec3 n, BodyState a, BodyState b, Vec3 come) {
  Vec3 relative = pc_sub(b.v, a.v);
  Real nearest = pc_min(pc_min(PC_LD(contact_rows, m, ROW_S), PC_LD(contact_rows, m, ROW_S + 1u)),
                        pc_min(PC_LD(contact_rows, m, ROW_S + 2u), PC_LD(contact_rows, m, ROW_S + 3u)));
  precise Real nearing = -pc_dot(n, relative);
  precise Real gap = nearest + pc_dot(n, come);
  precise Real flight = pc_max(gap, PC_REAL(0.0)) * pc_inverse_or_zero(nearing);
  Real since = pc_select(pc_impact_always(PC_PASS m), PC_LD(contact_rows, m, ROW_MET), PC_REAL(0.0));
  Mask stays = pc_and(since > PC_REAL(0.0), nearing < pc_noise(PC_PASS m, a, b));
  Real until = pc_select(stays, since, pc_min(flight, PC_INFO(h)));
  return pc_madd(come, relative, until);
}

// Two bodies before their impact, in the contact frame; and how they moved since the step began.
struct Encounter {
  Index ia;
  Index ib;
  BodyState a;
  BodyState b;
  Quad moved_a;
  Quad moved_b;
  Vec3 n;
  Vec3 t1;
  Vec3 t2;
  Arms arms;
  Twist v;
  Shift shift;
};
PC_FN Encounter pc_encounter(PC_IO Slot m) {
  Encounter x;
  x.ia = PC_ENDS(contact_ends, m, 0u);
  x.ib = PC_ENDS(contact_ends, m, 1u);
  x.a = pc_body_state(PC_PASS x.ia);
  x.b = pc_body_state(PC_PASS x.ib);
  x.moved_a = PC_GATHER(delta, x.ia, 0u);
  x.moved_b = PC_GATHER(delta, x.ib, 0u);
  x.n = pc_ld3_rows(PC_PASS m, ROW_N);
  x.t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  x.t2 = pc_cross(x.n, x.t1);
  Vec3 path = pc_impact_path(PC_PASS m, x.n, x.a, x.b, pc_sub(x.moved_b.v, x.moved_a.v));
  x.arms = pc_arms(PC_PASS m, pc_zero3(), path);
  x.v = pc_twist(x.a, x.b, x.arms, x.n, x.t1, x.t2);
  x.shift = pc_shift_of(PC_PASS m, x.n, x.t1, x.t2, x.moved_a, x.moved_b, PC_GATHER(delta, x.ia, 1u),
                        PC_GATHER(delta, x.ib, 1u));
  return x;
}
// What a row's point has along the normal of a shift, or of an acceleration in its place.
PC_FN Real pc_at_row(PC_IO Slot m, uint i, Shift shift) {
  precise Real at =
      shift.n + PC_LD(contact_rows, m, ROW_B + i) * shift.turn1 - PC_LD(contact_rows, m, ROW_A + i) * shift.turn2;
  return at;
}
PC_FN Real pc_gap_of_row(PC_IO Slot m, uint i, Shift shift) {
  precise Real s = PC_LD(contact_rows, m, ROW_S + i) + pc_at_row(PC_PASS m, i, shift);
  return s;
}

// What approaches no faster than the threshold does not bounce: |v*| is at most |u| + |A| h / 2, and has to be |A| h
// above it. Then the gap closes by at most |u| h + |A| h^2 / 8, less than 5 / 4 |u| h.
PC_FN Mask pc_closes_fast(PC_IO Slot m, Encounter x, uint i, Mask before) {
  Real u = pc_row_approach(PC_PASS m, i, x.v);
  precise Real slowest = PC_INFO(restitution_threshold) * PC_REAL(-0.5);
  precise Real most = u * PC_INFO(h) * PC_REAL(-2.0);
  return pc_or(before, pc_and(u < slowest, pc_gap_of_row(PC_PASS m, i, x.shift) < most));
}
PC_FN Mask pc_may_hit(PC_IO Slot m) {
  Encounter x = pc_encounter(PC_PASS m);
  Mask fast = pc_impact_always(PC_PASS m);
  fast = pc_closes_fast(PC_PASS m, x, 0u, fast);
  fast = pc_closes_fast(PC_PASS m, x, 1u, fast);
  fast = pc_closes_fast(PC_PASS m, x, 2u, fast);
  fast = pc_closes_fast(PC_PASS m, x, 3u, fast);
  return fast;
}

// How the rows close, all four.
struct Closings {
  Closing c0;
  Closing c1;
  Closing c2;
  Closing c3;
};
// How the gaps accelerate between impulses.
PC_FN Shift pc_pull(PC_IO Encounter x) {
  Acceleration a = pc_acceleration(PC_PASS x.ia, x.a);
  Acceleration b = pc_acceleration(PC_PASS x.ib, x.b);
  Vec3 centre = pc_sub(pc_add(b.a, pc_cross(b.turn, x.arms.b)), pc_add(a.a, pc_cross(a.turn, x.arms.a)));
  Vec3 turn = pc_sub(b.turn, a.turn);
  Shift pull;
  pull.n = pc_dot(x.n, centre);
  pull.turn1 = pc_dot(x.t1, turn);
  pull.turn2 = pc_dot(x.t2, turn);
  return pull;
}
PC_FN Closing pc_closing_of_row(PC_IO Slot m, uint i, Encounter x, Shift pull) {
  return pc_closing(PC_PASS pc_row_approach(PC_PASS m, i, x.v), pc_gap_of_row(PC_PASS m, i, x.shift),
                    pc_at_row(PC_PASS m, i, pull), PC_LD(contact_rows, m, ROW_MASS + i), PC_LD(contact_rows, m, ROW_E),
                    pc_impact_always(PC_PASS m));
}
PC_FN Closings pc_closings(PC_IO Slot m, Encounter x) {
  Shift pull = pc_pull(PC_PASS x);
  Closings c;
  c.c0 = pc_closing_of_row(PC_PASS m, 0u, x, pull);
  c.c1 = pc_closing_of_row(PC_PASS m, 1u, x, pull);
  c.c2 = pc_closing_of_row(PC_PASS m, 2u, x, pull);
  c.c3 = pc_closing_of_row(PC_PASS m, 3u, x, pull);
  return c;
}

// Equal shares of what stops the mean of the rows that close.
PC_FN FourRows pc_equal_shares(Closings c, FourRows mass, Couplings d) {
  Closing c0 = c.c0;
  Closing c1 = c.c1;
  Closing c2 = c.c2;
  Closing c3 = c.c3;
  precise Real own = c0.closes * pc_inverse_or_zero(mass.r0) + c1.closes * pc_inverse_or_zero(mass.r1) +
                     c2.closes * pc_inverse_or_zero(mass.r2) + c3.closes * pc_inverse_or_zero(mass.r3);
  precise Real coupled = c0.closes * (c1.closes * d.d01 + c2.closes * d.d02 + c3.closes * d.d03) +
                         c1.closes * (c2.closes * d.d12 + c3.closes * d.d13) + c2.closes * c3.closes * d.d23;
  precise Real whole = own + coupled * PC_REAL(2.0);
  precise Real missing = c0.closes * (c0.u_aim - c0.u) + c1.closes * (c1.u_aim - c1.u) + c2.closes * (c2.u_aim - c2.u) +
                         c3.closes * (c3.u_aim - c3.u);
  precise Real each = pc_max(missing, PC_REAL(0.0)) * pc_inverse_or_zero(whole);
  precise Real j0 = each * c0.closes;
  precise Real j1 = each * c1.closes;
  precise Real j2 = each * c2.closes;
  precise Real j3 = each * c3.closes;
  return pc_four(j0, j1, j2, j3);
}
// What each row asks for after the impulses j.
PC_FN FourRows pc_asked(Closings c, FourRows j, FourRows mass, Couplings d) {
  precise Real u0 = c.c0.u + j.r0 * pc_inverse_or_zero(mass.r0) + j.r1 * d.d01 + j.r2 * d.d02 + j.r3 * d.d03;
  precise Real u1 = c.c1.u + j.r0 * d.d01 + j.r1 * pc_inverse_or_zero(mass.r1) + j.r2 * d.d12 + j.r3 * d.d13;
  precise Real u2 = c.c2.u + j.r0 * d.d02 + j.r1 * d.d12 + j.r2 * pc_inverse_or_zero(mass.r2) + j.r3 * d.d23;
  precise Real u3 = c.c3.u + j.r0 * d.d03 + j.r1 * d.d13 + j.r2 * d.d23 + j.r3 * pc_inverse_or_zero(mass.r3);
  return pc_four(pc_impact_row(u0, c.c0, mass.r0), pc_impact_row(u1, c.c1, mass.r1), pc_impact_row(u2, c.c2, mass.r2),
                 pc_impact_row(u3, c.c3, mass.r3));
}
// Impulses of all rows that close, together: equal shares of what stops their mean, then rounds of what each asks for.
PC_FN FourRows pc_stopping_impulses(PC_IO Slot m, Closings c, Mask hits) {
  Real zero = PC_REAL(0.0);
  FourRows mass = pc_four(PC_LD(contact_rows, m, ROW_MASS), PC_LD(contact_rows, m, ROW_MASS + 1u),
                          PC_LD(contact_rows, m, ROW_MASS + 2u), PC_LD(contact_rows, m, ROW_MASS + 3u));
  Couplings d = pc_couplings(PC_PASS m);
  FourRows j = pc_equal_shares(c, mass, d);
  for (uint k = 0u; k < 8u; k++) {
    FourRows asked = pc_asked(c, j, mass, d);
    Real share = pc_common_share(j, asked, mass, d);
    precise Real n0 = j.r0 + asked.r0 * share;
    precise Real n1 = j.r1 + asked.r1 * share;
    precise Real n2 = j.r2 + asked.r2 * share;
    precise Real n3 = j.r3 + asked.r3 * share;
    j = pc_four(pc_max(n0, zero), pc_max(n1, zero), pc_max(n2, zero), pc_max(n3, zero));
  }
  return pc_four(pc_select(hits, j.r0, zero), pc_select(hits, j.r1, zero), pc_select(hits, j.r2, zero),
                 pc_select(hits, j.r3, zero));
}

// When the rows close, by the mean of their impulses j of the sum `whole`.
// None comes before one that a body of it had already.
PC_FN Real pc_instant(PC_IO Encounter x, Closings c, FourRows j, Real whole) {
  precise Real late = j.r0 * c.c0.t + j.r1 * c.c1.t + j.r2 * c.c2.t + j.r3 * c.c3.t;
  precise Real mean = late * pc_inverse_or_zero(whole);
  Quad hit_a = PC_GATHER(delta, x.ia, 2u);
  Quad hit_b = PC_GATHER(delta, x.ib, 2u);
  return pc_max(mean, pc_max(hit_a.v.x, hit_b.v.x));
}
// A body that turns far answers otherwise there than the rows think, and the points of two that both move do not close
// all at once: the impulse leaves no more energy than e allows.
PC_FN Real pc_allowed_share(PC_IO Slot m, Encounter x, Arms struck, Wrench w) {
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  Mask both_move = pc_and(x.a.inverse_mass > zero, x.b.inverse_mass > zero);
  Mask far = pc_or(both_move, pc_or(pc_turns_far(PC_PASS x.a, x.moved_a), pc_turns_far(PC_PASS x.b, x.moved_b)));
  precise Real most = (PC_LD(contact_rows, m, ROW_E) + one) * pc_calming_share(x.a, x.b, struck, w.impulse, w.couple);
  return pc_select(far, pc_clamp(most, zero, one), one);
}
// Notes when shapes that meet in flight did. (what rounding leaves of an approach closes anywhere)
PC_FN void pc_keep_met(PC_IO Slot m, Encounter x, Real t, Mask hits) {
  Vec3 relative = pc_sub(x.b.v, x.a.v);
  precise Real nearing = -pc_dot(x.n, relative);
  Real met = PC_LD(contact_rows, m, ROW_MET);
  Mask unmet = met < PC_TINY;
  Mask anew = pc_or(unmet, nearing > pc_noise(PC_PASS m, x.a, x.b));
  PC_ST(contact_rows, m, ROW_MET, pc_select(pc_and(pc_and(hits, pc_impact_always(PC_PASS m)), anew), t, met));
}
// The impulses j at the instant of the impact, with friction.
PC_FN void pc_strike(PC_IO Slot m, Encounter x, Closings c, FourRows j, Mask hits) {
  Real zero = PC_REAL(0.0);
  Push push = pc_push(PC_PASS m, j.r0, j.r1, j.r2, j.r3);
  Friction f = pc_coulomb(PC_PASS m, pc_pushed_twist(PC_PASS m, x.v, push), push.n, zero, zero, zero);
  Real t = pc_instant(PC_PASS x, c, j, push.n);
  // another sweep is to follow, until one changes nothing: else what others do would tell how many there are
  PC_RAISE(hits, velocity_parts, 2u);
  // the arms of the instant itself, which end in one point: so angular momentum is kept to rounding
  Arms struck = pc_arms(PC_PASS m, pc_madd(x.moved_a.v, x.a.v, t), pc_madd(x.moved_b.v, x.b.v, t));
  Wrench w = pc_wrench(x.n, x.t1, x.t2, push, f.change1, f.change2, f.change_twist);
  Real share = pc_allowed_share(PC_PASS m, x, struck, w);
  BodyState a = x.a;
  BodyState b = x.b;
  pc_apply(PC_PASS x.ia, x.ib, a, b, struck, pc_scale(w.impulse, share), pc_scale(w.couple, share));
  pc_keep_impact(PC_PASS m, 0u, j.r0, share);
  pc_keep_impact(PC_PASS m, 1u, j.r1, share);
  pc_keep_impact(PC_PASS m, 2u, j.r2, share);
  pc_keep_impact(PC_PASS m, 3u, j.r3, share);
  pc_keep_met(PC_PASS m, x, t, hits);
  pc_set_back(PC_PASS x.ia, x.a, a, t, hits);
  pc_set_back(PC_PASS x.ib, x.b, b, t, hits);
}
PC_FN_LARGE void pc_hit(PC_IO Slot m, Mask mine) {
  Encounter x = pc_encounter(PC_PASS m);
  Closings c = pc_closings(PC_PASS m, x);
  precise Real closing = c.c0.closes + c.c1.closes + c.c2.closes + c.c3.closes;
  Mask hits = pc_and(mine, closing > PC_REAL(0.0));
  if (!PC_ANY(hits)) return;  // lint: allow (zeros otherwise)
  // effective masses at the arms of the impact
  Responses r = pc_free_responses(x.a, x.b, x.arms.a, x.arms.b, x.n, x.t1, x.t2);
  r.these = hits;
  pc_renew_masses(PC_PASS m, r);
  pc_strike(PC_PASS m, x, c, pc_stopping_impulses(PC_PASS m, c, hits), hits);
}

// A sweep that is not the first of its sub-step comes in the coefficients of the relax pass: it looks at what the sweep
// before has struck, as the host has marked it (Detector::mark_struck).
PC_FN Mask pc_was_struck(PC_IO Slot m) {
  Quad a = PC_GATHER(delta, PC_ENDS(contact_ends, m, 0u), 2u);
  Quad b = PC_GATHER(delta, PC_ENDS(contact_ends, m, 1u), 2u);
  return pc_max(a.v.y, b.v.y) > PC_REAL(0.5);
}
PC_FN void pc_kernel(PC_IO Slot m) {
  Mask mine = pc_impact_mine(PC_PASS m);
  if (PC_ANY(PC_INFO(load_ahead) > PC_REAL(0.5))) {  // lint: allow (the same for all lanes)
    mine = pc_and(mine, pc_was_struck(PC_PASS m));
  }
  if (!PC_ANY(mine)) return;                                                 // lint: allow (nothing to do otherwise)
  if (PC_ANY(pc_and(mine, pc_may_hit(PC_PASS m)))) pc_hit(PC_PASS m, mine);  // lint: allow (nothing to do otherwise)
}
#undef PC_SOME_ROWS
