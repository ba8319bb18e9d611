// After the last sub-step, of contacts of trees that are too large for tree_contact_solve: rows that were pressed in
// this step and approached faster than the threshold leave with e times their approach speed (restitution e: the mean
// of the two bodies', as the original). The load that this adds allows more friction, so a bouncing manifold's friction
// is solved once more: in all mu (1 + e) times the impulse that stopped it, Newton's and Coulomb's laws together.
// These impulses are not remembered: they are of an instant, warm starting is for what lasts.
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_friction.inl"
#include "contact_together.inl"

// What a row asks for, as a change of its impulse.
PC_FN Real pc_restitution_row(PC_IO Real vn, Real approach, Real largest, Real e, Real mass) {
  precise Real threshold = -PC_INFO(restitution_threshold);
  Mask bounces = pc_and(pc_and(largest > PC_REAL(0.0), approach < threshold), e > PC_REAL(0.0));
  precise Real change = -(mass * (vn + e * approach));
  return pc_select(bounces, change, PC_REAL(0.0));
}
PC_FN Real pc_bounced_row(Real impulse, Real change, Real share) {
  precise Real next = impulse + change * share;
  return pc_snap(pc_max(next, PC_REAL(0.0)));
}

PC_FN Mask pc_bounces(PC_IO Slot m, uint i) {
  precise Real threshold = -PC_INFO(restitution_threshold);
  return pc_and(PC_LD(contact_impulses, m, IMPULSE_LARGEST + i) > PC_REAL(0.0),
                PC_LD(contact_rows, m, ROW_APPROACH + i) < threshold);
}

PC_FN void pc_note_bounce(PC_IO Slot m, uint i, Real bounce) {
  precise Real all = PC_LD(contact_impulses, m, IMPULSE_LARGEST + i) + bounce;
  PC_ST(contact_impulses, m, IMPULSE_LARGEST + i, all);
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Mask some = pc_or(pc_or(pc_bounces(PC_PASS m, 0u), pc_bounces(PC_PASS m, 1u)),
                    pc_or(pc_bounces(PC_PASS m, 2u), pc_bounces(PC_PASS m, 3u)));
  // of bodies on joints: contact_impact has seen to the others
  Real impact = PC_LD(contact_rows, m, ROW_IMPACT);
  some = pc_and(some, pc_and(impact<PC_REAL(-0.5), impact> PC_REAL(-2.0)));
  some = pc_and(some,
                pc_and(PC_LD(contact_rows, m, ROW_E) > PC_REAL(0.0), PC_LD(contact_rows, m, ROW_ACTS) > PC_REAL(0.0)));
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
  Real e = PC_LD(contact_rows, m, ROW_E);
  Real vn = v.vn;
  Real w1 = v.w1;
  Real w2 = v.w2;
  Real a0 = PC_LD(contact_rows, m, ROW_A);
  Real b0 = PC_LD(contact_rows, m, ROW_B);
  precise Real v0 = vn + b0 * w1 - a0 * w2;
  precise Real m0 = PC_LD(contact_rows, m, ROW_MASS);
  Real a1 = PC_LD(contact_rows, m, ROW_A + 1u);
  Real b1 = PC_LD(contact_rows, m, ROW_B + 1u);
  precise Real v1 = vn + b1 * w1 - a1 * w2;
  precise Real m1 = PC_LD(contact_rows, m, ROW_MASS + 1u);
  Real a2 = PC_LD(contact_rows, m, ROW_A + 2u);
  Real b2 = PC_LD(contact_rows, m, ROW_B + 2u);
  precise Real v2 = vn + b2 * w1 - a2 * w2;
  precise Real m2 = PC_LD(contact_rows, m, ROW_MASS + 2u);
  Real a3 = PC_LD(contact_rows, m, ROW_A + 3u);
  Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
  precise Real v3 = vn + b3 * w1 - a3 * w2;
  precise Real m3 = PC_LD(contact_rows, m, ROW_MASS + 3u);
  Real l0 = PC_LD(contact_impulses, m, 0u);
  Real r0 = pc_restitution_row(PC_PASS v0, PC_LD(contact_rows, m, ROW_APPROACH),
                               PC_LD(contact_impulses, m, IMPULSE_LARGEST), e, m0);
  Real l1 = PC_LD(contact_impulses, m, 1u);
  Real r1 = pc_restitution_row(PC_PASS v1, PC_LD(contact_rows, m, ROW_APPROACH + 1u),
                               PC_LD(contact_impulses, m, IMPULSE_LARGEST + 1u), e, m1);
  Real l2 = PC_LD(contact_impulses, m, 2u);
  Real r2 = pc_restitution_row(PC_PASS v2, PC_LD(contact_rows, m, ROW_APPROACH + 2u),
                               PC_LD(contact_impulses, m, IMPULSE_LARGEST + 2u), e, m2);
  Real l3 = PC_LD(contact_impulses, m, 3u);
  Real r3 = pc_restitution_row(PC_PASS v3, PC_LD(contact_rows, m, ROW_APPROACH + 3u),
                               PC_LD(contact_impulses, m, IMPULSE_LARGEST + 3u), e, m3);
  Real share = pc_common_share(pc_four(l0, l1, l2, l3), pc_four(r0, r1, r2, r3), pc_four(m0, m1, m2, m3),
                               pc_couplings(PC_PASS m));
  Real k0 = pc_bounced_row(l0, r0, share);
  Real k1 = pc_bounced_row(l1, r1, share);
  Real k2 = pc_bounced_row(l2, r2, share);
  Real k3 = pc_bounced_row(l3, r3, share);
  Real one = pc_select(some, PC_REAL(1.0), PC_REAL(0.0));
  precise Real e0 = (k0 - l0) * one;
  precise Real e1 = (k1 - l1) * one;
  precise Real e2 = (k2 - l2) * one;
  precise Real e3 = (k3 - l3) * one;

  pc_note_bounce(PC_PASS m, 0u, e0);
  pc_note_bounce(PC_PASS m, 1u, e1);
  pc_note_bounce(PC_PASS m, 2u, e2);
  pc_note_bounce(PC_PASS m, 3u, e3);
  Push push = pc_push(PC_PASS m, e0, e1, e2, e3);
  Mask bounced = push.n > PC_REAL(0.0);
  precise Real load = k0 + k1 + k2 + k3;
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
