// The rows of a manifold that was found anew in this sub-step: effective masses and responses between its rows, from
// the inertia of now (so the solver touches each body once per visit; docs/impulses.md). Others keep theirs.
#define PC_SOME_ROWS
#include "body_state.inl"
#include "contact_rows.inl"
#include "contact_masses.inl"
#include "free_responses.inl"
#include "contact_arms.inl"
#include "contact_shift.inl"

// A gap without what rounding has in it: of a difference of lengths so large nothing below `noise` is known, and at
// steps of 1e-4 s the speed that would close it in one is as large as what gravity makes.
PC_FN Real pc_extent(Vec3 arm) {
  precise Real r = pc_abs(arm.x) + pc_abs(arm.y) + pc_abs(arm.z);
  return r;
}
PC_FN Real pc_told_gap(Real s, Real noise) {
  precise Real r = s - pc_clamp(s, -noise, noise);
  return r;
}

// Of the way that two bodies move apart along the contact plane, what a's arm takes. A ball's point stays under its
// centre, whatever it rolls on; two balls divide the way by their radii; else the light body keeps its point (pc_arms).
PC_FN Mask pc_is_under(Vec3 arm, Vec3 n) {
  Vec3 off = pc_cross(arm, n);
  precise Real most = pc_dot(arm, arm) * PC_SLIGHT;
  return pc_dot(off, off) < most;
}
PC_FN Real pc_rolling_share(Vec3 arm_a, Vec3 arm_b, Vec3 n, Real light_a) {
  Mask ball_a = pc_is_under(arm_a, n);
  Mask ball_b = pc_is_under(arm_b, n);
  Real ra = pc_abs(pc_dot(arm_a, n));
  Real rb = pc_abs(pc_dot(arm_b, n));
  precise Real both = ra + rb;
  precise Real by_radius = ra * pc_inverse_or_zero(both);
  Real only_b = pc_select(ball_b, PC_REAL(1.0), light_a);
  Real with_a = pc_select(ball_b, by_radius, PC_REAL(0.0));
  return pc_select(ball_a, with_a, only_b);
}

PC_FN void pc_st_new(PC_IO Slot m, Mask these, uint f, Real x) {
  PC_ST(contact_rows, m, f, pc_select(these, x, PC_LD(contact_rows, m, f)));
}
PC_FN void pc_st3_new(PC_IO Slot m, Mask these, uint f, Vec3 v) {
  pc_st_new(PC_PASS m, these, f, v.x);
  pc_st_new(PC_PASS m, these, f + 1u, v.y);
  pc_st_new(PC_PASS m, these, f + 2u, v.z);
}
PC_FN void pc_st_pushes(PC_IO Slot m, Mask these, uint f, Real x) {
  PC_ST(contact_impulses, m, f, pc_select(these, x, PC_LD(contact_impulses, m, f)));
}
// What point `from` (from 1) of the rows held; 0 of none.
PC_FN Real pc_held_by(PC_IO Slot m, uint first, Real from) {
  Real r = pc_select(from > PC_REAL(0.5), PC_LD(contact_impulses, m, first), PC_REAL(0.0));
  r = pc_select(from > PC_REAL(1.0), PC_LD(contact_impulses, m, first + 1u), r);
  r = pc_select(from > PC_REAL(2.0), PC_LD(contact_impulses, m, first + 2u), r);
  precise Real past_two = from - PC_REAL(2.0);
  return pc_select(past_two > PC_REAL(1.0), PC_LD(contact_impulses, m, first + 3u), r);
}

// How fast a point approached, for restitution: the fastest of the step. What contact_impact has put in its place
// stays.
PC_FN void pc_keep_approach(PC_IO Slot m, uint i, Mask these, Mask of_step, Real approach) {
  Real before = pc_select(of_step, PC_REAL(0.0), PC_LD(contact_rows, m, ROW_APPROACH + i));
  Real fastest = pc_min(pc_min(approach, PC_REAL(0.0)), before);
  pc_st_new(PC_PASS m, these, ROW_APPROACH + i, pc_select(before > PC_REAL(0.0), before, fastest));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
  Index record = PC_ORDER(contact_order, m);
  Quad seen = PC_GATHER(contact, record, 8u);
  Mask of_step = PC_INFO(begins) > PC_REAL(0.5);
  Mask these = pc_or(of_step, seen.s > PC_REAL(0.5));
  if (!PC_ANY(these)) return;  // lint: allow (rows stand)
  Quad head = PC_GATHER(contact, record, 0u);
  Quad p0 = PC_GATHER(contact, record, 1u);
  Quad p1 = PC_GATHER(contact, record, 2u);
  Quad p2 = PC_GATHER(contact, record, 3u);
  Quad p3 = PC_GATHER(contact, record, 4u);
  Quad pushes = PC_GATHER(contact, record, 5u);
  Quad material = PC_GATHER(contact, record, 7u);
  Quad from = PC_GATHER(contact, record, 9u);
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);

  // contact frame
  // what came apart keeps the rows that it was struck by (contact_touch), but in trees, where all rows with mass are
  // solved
  Mask over = seen.s > PC_REAL(1.0);
  Mask jointed = material.s < PC_REAL(0.0);
  Mask unjointed = material.s > PC_REAL(-0.5);
  Mask all = these;
  Mask made = pc_or(of_step, pc_or(jointed, seen.s < PC_REAL(2.0)));
  these = pc_and(these, made);
  Vec3 n = head.v;
  Real count = pc_select(pc_and(over, jointed), PC_REAL(0.0), head.s);
  Mask steep = pc_abs(n.x) < PC_STEEP;
  Vec3 e = Vec3(pc_select(steep, one, zero), pc_select(steep, zero, one), zero);
  Vec3 t1 = pc_unit_or_zero(pc_madd(e, n, -pc_dot(e, n)));
  Vec3 t2 = pc_cross(n, t1);

  // centre, and the points about it; a missing point has weight zero
  Real w0 = pc_select(count > PC_REAL(0.5), one, zero);
  Real w1 = pc_select(count > PC_REAL(1.0), one, zero);
  precise Real past_two = count - PC_REAL(2.0);
  Real w2 = pc_select(past_two > zero, one, zero);
  Real w3 = pc_select(past_two > one, one, zero);
  Real share = pc_inverse_or_zero(count);
  precise Vec3 ra = (p0.v * w0 + p1.v * w1 + p2.v * w2 + p3.v * w3) * share;
  Vec3 apart = pc_negate(seen.v);
  // effective masses are those of the arms at impact, which pc_arms gives when the bodies have come so far
  precise Real k = a.inverse_mass + b.inverse_mass;
  precise Real light_a = b.inverse_mass * pc_inverse_or_zero(k);
  Real flight = pc_max(material.s, PC_REAL(0.0));
  precise Vec3 path = (b.v - a.v) * flight;
  Vec3 start_a = ra;
  Vec3 start_b = pc_add(ra, apart);
  Mask stays = pc_or(count > PC_REAL(1.0), pc_or(flight > zero, pc_min(a.inverse_mass, b.inverse_mass) < PC_TINY));
  Real share_a = pc_select(stays, light_a, pc_rolling_share(start_a, start_b, n, light_a));
  precise Real rest_a = share_a - PC_REAL(1.0);
  ra = pc_madd(start_a, path, share_a);
  Vec3 rb = pc_madd(start_b, path, rest_a);
  Vec3 d0 = pc_sub(p0.v, start_a);
  Vec3 d1 = pc_sub(p1.v, start_a);
  Vec3 d2 = pc_sub(p2.v, start_a);
  Vec3 d3 = pc_sub(p3.v, start_a);
  precise Real a0 = pc_dot(d0, t1) * w0;
  precise Real b0 = pc_dot(d0, t2) * w0;
  precise Real a1 = pc_dot(d1, t1) * w1;
  precise Real b1 = pc_dot(d1, t2) * w1;
  precise Real a2 = pc_dot(d2, t1) * w2;
  precise Real b2 = pc_dot(d2, t2) * w2;
  precise Real a3 = pc_dot(d3, t1) * w3;
  precise Real b3 = pc_dot(d3, t2) * w3;

  Responses r = pc_free_responses(a, b, ra, rb, n, t1, t2);
  r.these = these;

  precise Real spread = (a0 * a0 + b0 * b0 + a1 * a1 + b1 * b1 + a2 * a2 + b2 * b2 + a3 * a3 + b3 * b3) * share;
  Real radius = pc_sqrt(spread);

  // approach of each point, for restitution
  Vec3 wa = pc_angular_velocity(a);
  Vec3 wb = pc_angular_velocity(b);
  Vec3 va = pc_add(a.v, pc_cross(wa, ra));
  Vec3 vb = pc_add(b.v, pc_cross(wb, rb));
  Real vn = pc_dot(n, pc_sub(vb, va));
  Real r1 = pc_dot(t1, pc_sub(wb, wa));
  Real r2 = pc_dot(t2, pc_sub(wb, wa));
  precise Real approach0 = vn + b0 * r1 - a0 * r2;
  precise Real approach1 = vn + b1 * r1 - a1 * r2;
  precise Real approach2 = vn + b2 * r1 - a2 * r2;
  precise Real approach3 = vn + b3 * r1 - a3 * r2;

#ifndef PC_FRICTIONLESS
  // what the rows hold is of the frame before
  Vec3 old_t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 old_t2 = pc_cross(pc_ld3_rows(PC_PASS m, ROW_N), old_t1);
#endif
  pc_st3_new(PC_PASS m, these, ROW_N, n);
  pc_st3_new(PC_PASS m, these, ROW_T, t1);
  pc_st_new(PC_PASS m, these, ROW_SHARE, share_a);
  // rows go by the motion since the step began (pc_arms, pc_shift_of), less what there was of it
  Vec3 gone = pc_sub(moved_b.v, moved_a.v);
  pc_st3_new(PC_PASS m, these, ROW_ARM_A, ra);
  pc_st3_new(PC_PASS m, these, ROW_ARM_B, rb);
  pc_st3_new(PC_PASS m, these, ROW_PATH, pc_add(gone, path));
  Shift shift = pc_shift_of(PC_PASS m, n, t1, t2, moved_a, moved_b, PC_GATHER(delta, ia, 1u), PC_GATHER(delta, ib, 1u));
  pc_st_new(PC_PASS m, these, ROW_A, a0);
  pc_st_new(PC_PASS m, these, ROW_A + 1u, a1);
  pc_st_new(PC_PASS m, these, ROW_A + 2u, a2);
  pc_st_new(PC_PASS m, these, ROW_A + 3u, a3);
  pc_st_new(PC_PASS m, these, ROW_B, b0);
  pc_st_new(PC_PASS m, these, ROW_B + 1u, b1);
  pc_st_new(PC_PASS m, these, ROW_B + 2u, b2);
  pc_st_new(PC_PASS m, these, ROW_B + 3u, b3);
  // missing points take the mean gap of the others, so that none is the nearest
  precise Real gap = (p0.s * w0 + p1.s * w1 + p2.s * w2 + p3.s * w3) * share;
  precise Real reach = pc_extent(start_a) + pc_extent(start_b) + radius;
  precise Real rounding = reach * PC_EPSILON;
  // (of what bounces the instant counts)
  Real noise = pc_select(pc_or(flight > zero, material.v.z > zero), zero, rounding);
  precise Real s0 = pc_told_gap(p0.s, noise) - (shift.n + b0 * shift.turn1 - a0 * shift.turn2);
  precise Real s1 =
      pc_told_gap(pc_select(w1 > zero, p1.s, gap), noise) - (shift.n + b1 * shift.turn1 - a1 * shift.turn2);
  precise Real s2 =
      pc_told_gap(pc_select(w2 > zero, p2.s, gap), noise) - (shift.n + b2 * shift.turn1 - a2 * shift.turn2);
  precise Real s3 =
      pc_told_gap(pc_select(w3 > zero, p3.s, gap), noise) - (shift.n + b3 * shift.turn1 - a3 * shift.turn2);
  pc_st_new(PC_PASS m, these, ROW_S, s0);
  pc_st_new(PC_PASS m, these, ROW_S + 1u, s1);
  pc_st_new(PC_PASS m, these, ROW_S + 2u, s2);
  pc_st_new(PC_PASS m, these, ROW_S + 3u, s3);
  pc_store_masses(PC_PASS m, r, w0, w1, w2, w3);
  // contact_solve leaves alone what has no point; of what meets within the sub-step, and does not bounce, it stops the
  // approach that contact_impact leaves
  Real acts = pc_select(pc_or(over, pc_and(flight > zero, material.v.z > zero)), zero, w0);
  pc_st_new(PC_PASS m, all, ROW_K, pc_select(acts > zero, PC_LD(contact_rows, m, ROW_K), zero));
#ifndef PC_FRICTIONLESS
  pc_st_new(PC_PASS m, these, ROW_MU_STATIC, material.v.x);
  pc_st_new(PC_PASS m, these, ROW_MU_KINETIC, material.v.y);
  pc_st_new(PC_PASS m, these, ROW_RADIUS, radius);
#endif
  pc_st_new(PC_PASS m, these, ROW_E, material.v.z);
  pc_st_new(PC_PASS m, all, ROW_IMPACT, pc_select(pc_and(over, unjointed), PC_REAL(-2.0), material.s));
  precise Real sent = PC_INFO(sent) * PC_REAL(2.0);
  // 0 as ROW_MET: they have not met
  pc_st_new(PC_PASS m, these, ROW_ACTS, pc_select(flight > zero, zero, pc_select(of_step, one, sent)));
  pc_keep_approach(PC_PASS m, 0u, these, of_step, approach0);
  pc_keep_approach(PC_PASS m, 1u, these, of_step, approach1);
  pc_keep_approach(PC_PASS m, 2u, these, of_step, approach2);
  pc_keep_approach(PC_PASS m, 3u, these, of_step, approach3);

  // impulses: of the step before, which scale with the sub-step; or those that the rows hold
  Real ratio = PC_INFO(impulse_ratio);
  precise Vec3 told_v = pushes.v * ratio;
  precise Real told_s = pushes.s * ratio;
  Real h0 = pc_held_by(PC_PASS m, 0u, from.v.x);
  Real h1 = pc_held_by(PC_PASS m, 0u, from.v.y);
  Real h2 = pc_held_by(PC_PASS m, 0u, from.v.z);
  Real h3 = pc_held_by(PC_PASS m, 0u, from.s);
  Real k0 = pc_select(over, zero, w0);
  Real k1 = pc_select(over, zero, w1);
  Real k2 = pc_select(over, zero, w2);
  Real k3 = pc_select(over, zero, w3);
  precise Real l0 = pc_select(of_step, told_v.x, h0) * k0;
  precise Real l1 = pc_select(of_step, told_v.y, h1) * k1;
  precise Real l2 = pc_select(of_step, told_v.z, h2) * k2;
  precise Real l3 = pc_select(of_step, told_s, h3) * k3;
  pc_st_pushes(PC_PASS m, all, 0u, l0);
  pc_st_pushes(PC_PASS m, all, 1u, l1);
  pc_st_pushes(PC_PASS m, all, 2u, l2);
  pc_st_pushes(PC_PASS m, all, 3u, l3);
  pc_st_pushes(PC_PASS m, all, IMPULSE_LAST, l0);
  pc_st_pushes(PC_PASS m, all, IMPULSE_LAST + 1u, l1);
  pc_st_pushes(PC_PASS m, all, IMPULSE_LAST + 2u, l2);
  pc_st_pushes(PC_PASS m, all, IMPULSE_LAST + 3u, l3);
#ifndef PC_FRICTIONLESS
  Quad drag = PC_GATHER(contact, record, 6u);
  Real old1 = PC_LD(contact_impulses, m, IMPULSE_T);
  Real old2 = PC_LD(contact_impulses, m, IMPULSE_T + 1u);
  Real old_twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u);
  precise Vec3 held = old_t1 * old1 + old_t2 * old2;
  precise Vec3 dragged = drag.v * ratio;
  precise Real twisted = drag.s * ratio;
  Vec3 friction = pc_select3(of_step, dragged, held);
  Real any =
      pc_select(pc_or(of_step, pc_max(pc_max(from.v.x, from.v.y), pc_max(from.v.z, from.s)) > PC_REAL(0.5)), k0, zero);
  Mask held_some = any > zero;
  Real f1 = pc_select(held_some, pc_dot(t1, friction), zero);
  Real f2 = pc_select(held_some, pc_dot(t2, friction), zero);
  Real ft = pc_select(held_some, pc_select(of_step, twisted, old_twist), zero);
  pc_st_pushes(PC_PASS m, all, IMPULSE_T, f1);
  pc_st_pushes(PC_PASS m, all, IMPULSE_T + 1u, f2);
  pc_st_pushes(PC_PASS m, all, IMPULSE_T + 2u, ft);
#endif
  for (uint i = 0u; i < 4u; i++) pc_st_pushes(PC_PASS m, of_step, IMPULSE_LARGEST + i, zero);
  precise Real load = l0 + l1 + l2 + l3;
  pc_st_pushes(PC_PASS m, all, IMPULSE_BEFORE, load);
}
#undef PC_SOME_ROWS
