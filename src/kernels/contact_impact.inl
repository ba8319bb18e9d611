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
#include "free_responses.inl"
#include "contact_coulomb.inl"
#include "contact_together.inl"
#include "contact_turned.inl"
#include "contact_calming.inl"
#include "contact_blow.inl"

// u_aim: the velocity u that the row is to leave with; closes: 1 or 0
struct Closing {
  Real t;
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
  r.u_aim = aim;
  r.closes = pc_select(now, PC_REAL(1.0), zero);
  return r;
}
// What a row asks for, as a change of its impulse.
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

#define PC_IMPACT_NOISE PC_REAL(64.0)
// An approach up to this is what rounding leaves of one: of the impulses that stop it and of the sweeps that look
// again, 64 times what counts as rest.
PC_FN Real pc_noise(PC_IO Vec3 relative) {
  precise Real r = PC_INFO(rounding) * PC_IMPACT_NOISE * pc_sqrt(pc_dot(relative, relative));
  return r;
}

// The way to the arms at impact: when the centres have come as near as the narrowest gap is wide. (Arms that are not
// those of the way that was really gone would answer otherwise than masses say, and make energy.) Two that have met,
// and that nothing has brought together again since, are seen at that instant: at an earlier or later one the point of
// their impact has moved on with one and not with the other, and their spins would look like an approach.
PC_FN Vec3 pc_impact_path(PC_IO Slot m, Vec3 n, Vec3 relative, Vec3 come) {
  Real nearest = pc_min(pc_min(PC_LD(contact_rows, m, ROW_S), PC_LD(contact_rows, m, ROW_S + 1u)),
                        pc_min(PC_LD(contact_rows, m, ROW_S + 2u), PC_LD(contact_rows, m, ROW_S + 3u)));
  precise Real nearing = -pc_dot(n, relative);
  precise Real gap = nearest + pc_dot(n, come);
  precise Real flight = pc_max(gap, PC_REAL(0.0)) * pc_inverse_or_zero(nearing);
  Real since = pc_select(pc_impact_always(PC_PASS m), PC_LD(contact_rows, m, ROW_MET), PC_REAL(0.0));
  Mask stays = pc_and(since > PC_REAL(0.0), nearing < pc_noise(PC_PASS relative));
  Real until = pc_select(stays, since, pc_min(flight, PC_INFO(h)));
  return pc_madd(come, relative, until);
}

// What approaches no faster than the threshold does not bounce: |v*| is at most |u| + |A| h / 2, and has to be |A| h
// above it. Then the gap closes by at most |u| h + |A| h^2 / 8, less than 5 / 4 |u| h.
PC_FN Mask pc_closes_fast(PC_IO Slot m, Twist v, Shift shift, uint i, Mask before) {
  Real a = PC_LD(contact_rows, m, ROW_A + i);
  Real b = PC_LD(contact_rows, m, ROW_B + i);
  precise Real u = v.vn + b * v.w1 - a * v.w2;
  precise Real s = PC_LD(contact_rows, m, ROW_S + i) + (shift.n + b * shift.turn1 - a * shift.turn2);
  precise Real slowest = PC_INFO(restitution_threshold) * PC_REAL(-0.5);
  precise Real most = u * PC_INFO(h) * PC_REAL(-2.0);
  return pc_or(before, pc_and(u < slowest, s < most));
}
PC_FN Mask pc_may_hit(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms =
      pc_arms(PC_PASS m, pc_zero3(), pc_impact_path(PC_PASS m, n, pc_sub(b.v, a.v), pc_sub(moved_b.v, moved_a.v)));
  Twist v = pc_twist(a, b, arms, n, t1, t2);
  Shift shift = pc_shift_of(PC_PASS m, n, t1, t2, moved_a, moved_b, PC_GATHER(delta, ia, 1u), PC_GATHER(delta, ib, 1u));
  Mask fast = pc_impact_always(PC_PASS m);
  fast = pc_closes_fast(PC_PASS m, v, shift, 0u, fast);
  fast = pc_closes_fast(PC_PASS m, v, shift, 1u, fast);
  fast = pc_closes_fast(PC_PASS m, v, shift, 2u, fast);
  fast = pc_closes_fast(PC_PASS m, v, shift, 3u, fast);
  return fast;
}
PC_FN_LARGE void pc_hit(PC_IO Slot m, Mask mine) {
  Real zero = PC_REAL(0.0);
  Real e = PC_LD(contact_rows, m, ROW_E);
  Mask always = pc_impact_always(PC_PASS m);
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);

  Vec3 relative = pc_sub(b.v, a.v);
  Vec3 come = pc_sub(moved_b.v, moved_a.v);
  Vec3 path = pc_impact_path(PC_PASS m, n, relative, come);
  Mask both_move = pc_and(a.inverse_mass > zero, b.inverse_mass > zero);
  Arms arms = pc_arms(PC_PASS m, pc_zero3(), path);
  Twist v = pc_twist(a, b, arms, n, t1, t2);

  Real a0 = PC_LD(contact_rows, m, ROW_A);
  Real a1 = PC_LD(contact_rows, m, ROW_A + 1u);
  Real a2 = PC_LD(contact_rows, m, ROW_A + 2u);
  Real a3 = PC_LD(contact_rows, m, ROW_A + 3u);
  Real b0 = PC_LD(contact_rows, m, ROW_B);
  Real b1 = PC_LD(contact_rows, m, ROW_B + 1u);
  Real b2 = PC_LD(contact_rows, m, ROW_B + 2u);
  Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
  precise Real u0 = v.vn + b0 * v.w1 - a0 * v.w2;
  precise Real u1 = v.vn + b1 * v.w1 - a1 * v.w2;
  precise Real u2 = v.vn + b2 * v.w1 - a2 * v.w2;
  precise Real u3 = v.vn + b3 * v.w1 - a3 * v.w2;

  // gaps, and accelerations in the contact frame
  Shift shift = pc_shift_of(PC_PASS m, n, t1, t2, moved_a, moved_b, PC_GATHER(delta, ia, 1u), PC_GATHER(delta, ib, 1u));
  Real shift_n = shift.n;
  Real turn1 = shift.turn1;
  Real turn2 = shift.turn2;
  Acceleration pull_a = pc_acceleration(PC_PASS ia, a);
  Acceleration pull_b = pc_acceleration(PC_PASS ib, b);
  Vec3 pull = pc_sub(pc_add(pull_b.a, pc_cross(pull_b.turn, arms.b)), pc_add(pull_a.a, pc_cross(pull_a.turn, arms.a)));
  Vec3 spin_up = pc_sub(pull_b.turn, pull_a.turn);
  Real pull_n = pc_dot(n, pull);
  Real up1 = pc_dot(t1, spin_up);
  Real up2 = pc_dot(t2, spin_up);
  precise Real s0 = PC_LD(contact_rows, m, ROW_S) + (shift_n + b0 * turn1 - a0 * turn2);
  precise Real s1 = PC_LD(contact_rows, m, ROW_S + 1u) + (shift_n + b1 * turn1 - a1 * turn2);
  precise Real s2 = PC_LD(contact_rows, m, ROW_S + 2u) + (shift_n + b2 * turn1 - a2 * turn2);
  precise Real s3 = PC_LD(contact_rows, m, ROW_S + 3u) + (shift_n + b3 * turn1 - a3 * turn2);
  precise Real g0 = pull_n + b0 * up1 - a0 * up2;
  precise Real g1 = pull_n + b1 * up1 - a1 * up2;
  precise Real g2 = pull_n + b2 * up1 - a2 * up2;
  precise Real g3 = pull_n + b3 * up1 - a3 * up2;
  Real m0 = PC_LD(contact_rows, m, ROW_MASS);
  Real m1 = PC_LD(contact_rows, m, ROW_MASS + 1u);
  Real m2 = PC_LD(contact_rows, m, ROW_MASS + 2u);
  Real m3 = PC_LD(contact_rows, m, ROW_MASS + 3u);
  Closing c0 = pc_closing(PC_PASS u0, s0, g0, m0, e, always);
  Closing c1 = pc_closing(PC_PASS u1, s1, g1, m1, e, always);
  Closing c2 = pc_closing(PC_PASS u2, s2, g2, m2, e, always);
  Closing c3 = pc_closing(PC_PASS u3, s3, g3, m3, e, always);
  precise Real closing = c0.closes + c1.closes + c2.closes + c3.closes;
  Mask hits = pc_and(mine, closing > zero);
  if (!PC_ANY(hits)) return;  // lint: allow (zeros otherwise)

  // effective masses at the arms of the impact
  Responses r = pc_free_responses(a, b, arms.a, arms.b, n, t1, t2);
  r.these = hits;
  pc_renew_masses(PC_PASS m, r);
  m0 = PC_LD(contact_rows, m, ROW_MASS);
  m1 = PC_LD(contact_rows, m, ROW_MASS + 1u);
  m2 = PC_LD(contact_rows, m, ROW_MASS + 2u);
  m3 = PC_LD(contact_rows, m, ROW_MASS + 3u);
  // all rows that close, together: equal shares of what stops their mean, then rounds of what each asks for
  Real d01 = PC_LD(contact_rows, m, ROW_D);
  Real d02 = PC_LD(contact_rows, m, ROW_D + 1u);
  Real d03 = PC_LD(contact_rows, m, ROW_D + 2u);
  Real d12 = PC_LD(contact_rows, m, ROW_D + 3u);
  Real d13 = PC_LD(contact_rows, m, ROW_D + 4u);
  Real d23 = PC_LD(contact_rows, m, ROW_D + 5u);
  precise Real own = c0.closes * pc_inverse_or_zero(m0) + c1.closes * pc_inverse_or_zero(m1) +
                     c2.closes * pc_inverse_or_zero(m2) + c3.closes * pc_inverse_or_zero(m3);
  precise Real coupled = c0.closes * (c1.closes * d01 + c2.closes * d02 + c3.closes * d03) +
                         c1.closes * (c2.closes * d12 + c3.closes * d13) + c2.closes * c3.closes * d23;
  precise Real whole = own + coupled * PC_REAL(2.0);
  precise Real missing = c0.closes * (c0.u_aim - u0) + c1.closes * (c1.u_aim - u1) + c2.closes * (c2.u_aim - u2) +
                         c3.closes * (c3.u_aim - u3);
  precise Real each = pc_max(missing, zero) * pc_inverse_or_zero(whole);
  precise Real j0 = each * c0.closes;
  precise Real j1 = each * c1.closes;
  precise Real j2 = each * c2.closes;
  precise Real j3 = each * c3.closes;
  FourRows masses = pc_four(m0, m1, m2, m3);
  Couplings d;
  d.d01 = d01;
  d.d02 = d02;
  d.d03 = d03;
  d.d12 = d12;
  d.d13 = d13;
  d.d23 = d23;
  for (uint k = 0u; k < 8u; k++) {
    precise Real r0 = u0 + j0 * pc_inverse_or_zero(m0) + j1 * d01 + j2 * d02 + j3 * d03;
    precise Real r1 = u1 + j0 * d01 + j1 * pc_inverse_or_zero(m1) + j2 * d12 + j3 * d13;
    precise Real r2 = u2 + j0 * d02 + j1 * d12 + j2 * pc_inverse_or_zero(m2) + j3 * d23;
    precise Real r3 = u3 + j0 * d03 + j1 * d13 + j2 * d23 + j3 * pc_inverse_or_zero(m3);
    FourRows asked = pc_four(pc_impact_row(r0, c0, m0), pc_impact_row(r1, c1, m1), pc_impact_row(r2, c2, m2),
                             pc_impact_row(r3, c3, m3));
    Real share = pc_common_share(pc_four(j0, j1, j2, j3), asked, masses, d);
    precise Real n0 = j0 + asked.r0 * share;
    precise Real n1 = j1 + asked.r1 * share;
    precise Real n2 = j2 + asked.r2 * share;
    precise Real n3 = j3 + asked.r3 * share;
    j0 = pc_max(n0, zero);
    j1 = pc_max(n1, zero);
    j2 = pc_max(n2, zero);
    j3 = pc_max(n3, zero);
  }
  j0 = pc_select(hits, j0, zero);
  j1 = pc_select(hits, j1, zero);
  j2 = pc_select(hits, j2, zero);
  j3 = pc_select(hits, j3, zero);

  Push push = pc_push(PC_PASS m, j0, j1, j2, j3);
  Friction f = pc_coulomb(PC_PASS m, pc_pushed_twist(PC_PASS m, v, push), push.n, zero, zero, zero);
  precise Real late = j0 * c0.t + j1 * c1.t + j2 * c2.t + j3 * c3.t;
  precise Real mean = late * pc_inverse_or_zero(push.n);
  // none comes before one that a body of it had already
  Quad hit_a = PC_GATHER(delta, ia, 2u);
  Quad hit_b = PC_GATHER(delta, ib, 2u);
  Real t = pc_max(mean, pc_max(hit_a.v.x, hit_b.v.x));

  // another sweep is to follow, until one changes nothing: else what others do would tell how many there are
  PC_RAISE(hits, velocity_parts, 2u);
  // the arms of the instant itself, which end in one point: so angular momentum is kept to rounding
  Arms struck = pc_arms(PC_PASS m, pc_madd(moved_a.v, a.v, t), pc_madd(moved_b.v, b.v, t));
  BodyState before_a = a;
  BodyState before_b = b;
  Wrench w = pc_wrench(n, t1, t2, push, f.change1, f.change2, f.change_twist);
  // a body that turns far answers otherwise there than the rows think, and the points of two that both move do not
  // close all at once: the impulse leaves no more energy than e allows
  Mask far = pc_or(both_move, pc_or(pc_turns_far(PC_PASS a, moved_a), pc_turns_far(PC_PASS b, moved_b)));
  precise Real most = (e + PC_REAL(1.0)) * pc_calming_share(a, b, struck, w.impulse, w.couple);
  Real share = pc_select(far, pc_clamp(most, zero, PC_REAL(1.0)), PC_REAL(1.0));
  pc_apply(PC_PASS ia, ib, a, b, struck, pc_scale(w.impulse, share), pc_scale(w.couple, share));
  pc_keep_impact(PC_PASS m, 0u, j0, share);
  pc_keep_impact(PC_PASS m, 1u, j1, share);
  pc_keep_impact(PC_PASS m, 2u, j2, share);
  pc_keep_impact(PC_PASS m, 3u, j3, share);
  // (what rounding leaves of an approach closes anywhere)
  precise Real nearing = -pc_dot(n, relative);
  Real met = PC_LD(contact_rows, m, ROW_MET);
  Mask anew = pc_or(met<PC_TINY, nearing> pc_noise(PC_PASS relative));
  PC_ST(contact_rows, m, ROW_MET, pc_select(pc_and(pc_and(hits, always), anew), t, met));
  pc_set_back(PC_PASS ia, before_a, a, t, hits);
  pc_set_back(PC_PASS ib, before_b, b, t, hits);
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
