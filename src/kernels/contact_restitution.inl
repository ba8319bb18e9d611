// After the last sub-step, of contacts of trees that are too large for tree_contact_solve: rows that were pressed in
// this step and approached faster than the threshold leave with e times their approach speed (restitution e: the mean
// of the two bodies', as the original). The load that this adds allows more friction, so a bouncing manifold's friction
// is solved once more: in all mu (1 + e) times the impulse that stopped it, Newton's and Coulomb's laws together.
// These impulses are not remembered: they are of an instant, warm starting is for what lasts.
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_friction.inl"
#include "contact_together.inl"
#include "row_approach.inl"

PC_FN Mask pc_bounces(PC_IO Slot m, uint i) {
  precise Real threshold = -PC_INFO(restitution_threshold);
  return pc_and(PC_LD(contact_impulses, m, IMPULSE_LARGEST + i) > PC_REAL(0.0),
                PC_LD(contact_rows, m, ROW_APPROACH + i) < threshold);
}
// Whether any row does, of bodies on joints: contact_impact has seen to the others.
PC_FN Mask pc_some_bounce(PC_IO Slot m) {
  Mask some = pc_or(pc_or(pc_bounces(PC_PASS m, 0u), pc_bounces(PC_PASS m, 1u)),
                    pc_or(pc_bounces(PC_PASS m, 2u), pc_bounces(PC_PASS m, 3u)));
  Real impact = PC_LD(contact_rows, m, ROW_IMPACT);
  some = pc_and(some, pc_and(impact<PC_REAL(-0.5), impact> PC_REAL(-2.0)));
  return pc_and(some,
                pc_and(PC_LD(contact_rows, m, ROW_E) > PC_REAL(0.0), PC_LD(contact_rows, m, ROW_ACTS) > PC_REAL(0.0)));
}

// What a row asks for, as a change of its impulse.
PC_FN Real pc_restitution_row(PC_IO Slot m, uint i, Twist v) {
  Real e = PC_LD(contact_rows, m, ROW_E);
  Mask bounces = pc_and(pc_bounces(PC_PASS m, i), e > PC_REAL(0.0));
  precise Real aim = pc_row_approach(PC_PASS m, i, v) + e * PC_LD(contact_rows, m, ROW_APPROACH + i);
  precise Real change = -(PC_LD(contact_rows, m, ROW_MASS + i) * aim);
  return pc_select(bounces, change, PC_REAL(0.0));
}
PC_FN Real pc_bounced_row(Real impulse, Real change, Real share) {
  precise Real next = impulse + change * share;
  return pc_snap(pc_max(next, PC_REAL(0.0)));
}
PC_FN FourRows pc_bounced_rows(PC_IO Slot m, FourRows now, Twist v) {
  FourRows change = pc_four(pc_restitution_row(PC_PASS m, 0u, v), pc_restitution_row(PC_PASS m, 1u, v),
                            pc_restitution_row(PC_PASS m, 2u, v), pc_restitution_row(PC_PASS m, 3u, v));
  FourRows mass = pc_four(PC_LD(contact_rows, m, ROW_MASS), PC_LD(contact_rows, m, ROW_MASS + 1u),
                          PC_LD(contact_rows, m, ROW_MASS + 2u), PC_LD(contact_rows, m, ROW_MASS + 3u));
  Real share = pc_common_share(now, change, mass, pc_couplings(PC_PASS m));
  return pc_four(pc_bounced_row(now.r0, change.r0, share), pc_bounced_row(now.r1, change.r1, share),
                 pc_bounced_row(now.r2, change.r2, share), pc_bounced_row(now.r3, change.r3, share));
}

// What a row bounced by, which it notes.
PC_FN Real pc_note_bounce(PC_IO Slot m, uint i, Mask some, Real before, Real after) {
  precise Real bounce = (after - before) * pc_select(some, PC_REAL(1.0), PC_REAL(0.0));
  precise Real all = PC_LD(contact_impulses, m, IMPULSE_LARGEST + i) + bounce;
  PC_ST(contact_impulses, m, IMPULSE_LARGEST + i, all);
  return bounce;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Mask some = pc_some_bounce(PC_PASS m);
  if (!PC_ANY(some)) return;  // lint: allow (others change nothing)
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  Twist v = pc_twist(a, b, arms, n, t1, t2);
  FourRows before = pc_four(PC_LD(contact_impulses, m, 0u), PC_LD(contact_impulses, m, 1u),
                            PC_LD(contact_impulses, m, 2u), PC_LD(contact_impulses, m, 3u));
  FourRows after = pc_bounced_rows(PC_PASS m, before, v);
  Real e0 = pc_note_bounce(PC_PASS m, 0u, some, before.r0, after.r0);
  Real e1 = pc_note_bounce(PC_PASS m, 1u, some, before.r1, after.r1);
  Real e2 = pc_note_bounce(PC_PASS m, 2u, some, before.r2, after.r2);
  Real e3 = pc_note_bounce(PC_PASS m, 3u, some, before.r3, after.r3);
  Push push = pc_push(PC_PASS m, e0, e1, e2, e3);
  Mask bounced = push.n > PC_REAL(0.0);
  precise Real load = after.r0 + after.r1 + after.r2 + after.r3;
  Friction f = pc_friction(PC_PASS m, pc_pushed_twist(PC_PASS m, v, push), load);
  Real zero = PC_REAL(0.0);
  Real c1 = pc_select(bounced, f.change1, zero);
  Real c2 = pc_select(bounced, f.change2, zero);
  Real ct = pc_select(bounced, f.change_twist, zero);
  // a bounce is an impact: the velocity it leaves is the one to be read, whole (see synchronise)
  Real touch = pc_select(bounced, push.n, zero);
  pc_spare(a, some);
  pc_spare(b, some);
  a.phase = pc_select(a.inverse_mass > zero, pc_max(a.phase, touch), a.phase);
  b.phase = pc_select(b.inverse_mass > zero, pc_max(b.phase, touch), b.phase);
  Wrench w = pc_wrench(n, t1, t2, push, c1, c2, ct);
  pc_apply(PC_PASS ia, ib, a, b, arms, w.impulse, w.couple);
}
