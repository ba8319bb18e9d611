// A manifold whose load has just come, or whose friction has just let go: its rows are solved together, by further
// rounds of friction and normal rows. One round a visit is enough where the last sub-step's impulses still hold; here
// they do not, and what one round leaves (a box that tilts a little, and slides while it does) is never undone.

const uint SETTLE_ROUNDS = 16u;  // of a visit that takes rounds; all lanes make as many

// Whether rounds are needed: more than one point, and the load becomes settled_load times what it is, or that part of
// it (of an impact that is remembered nothing is left); or in the biased visit friction changes by half of its limit.
// (Bodies that stand side by side press each other by rounding alone: no load.)
PC_FN Mask pc_unsettled(PC_IO Slot m, Real load, Real arriving, Real coming, Real mass, Friction f) {
  precise Real least = mass * PC_INFO(least_load);
  Mask loaded = pc_max(load, pc_max(arriving, coming)) > least;
  precise Real more = arriving - load * PC_INFO(settled_load);
  precise Real less = load - pc_max(arriving, PC_REAL(0.0)) * PC_INFO(settled_load);
  Mask several = pc_and(PC_LD(contact_rows, m, ROW_MASS + 1u) > PC_REAL(0.0), loaded);
  Mask changes = pc_max(more, less) > PC_REAL(0.0);
#ifndef PC_FRICTIONLESS
  precise Real change = f.change1 * f.change1 + f.change2 * f.change2;
  precise Real limit = coming * PC_LD(contact_rows, m, ROW_MU_KINETIC) * PC_REAL(0.5);
  precise Real square = limit * limit;
  Mask biased = PC_INFO(load_ahead) < PC_REAL(0.5);
  changes = pc_or(changes, pc_and(biased, change > square));
#endif
  return pc_and(several, changes);
}

// In a round all rows move at once, so that no point comes before another: each by a share of what would stop its own
// point that is safe whatever the others do (half as much again as its part in the sum of the responses that it feels).
PC_FN Real pc_pace(Real own, Real x, Real y, Real z) {
  precise Real sum = own + pc_abs(x) + pc_abs(y) + pc_abs(z);
  precise Real pace = own * pc_inverse_or_zero(sum);
  precise Real more = pace + pace * PC_REAL(0.5);
  return pc_min(more, PC_REAL(1.0));
}
PC_FN Real pc_settled_row(PC_IO Real v, Real s, Real mass, Real now, Real pace, Real loose) {
  precise Real next = now + (pc_normal_row(PC_PASS v, s, mass, now, loose) - now) * pace;
  return pc_snap(next);
}

// `v`: the twist before the visit; `r`: impulses after the visit's one round.
PC_FN void pc_settle(PC_IO Slot m, Twist v, Gaps gap, Real loose, Mask unsettled, PC_INOUT(Rows) r) {
  Real a0 = PC_LD(contact_rows, m, ROW_A);
  Real a1 = PC_LD(contact_rows, m, ROW_A + 1u);
  Real a2 = PC_LD(contact_rows, m, ROW_A + 2u);
  Real a3 = PC_LD(contact_rows, m, ROW_A + 3u);
  Real b0 = PC_LD(contact_rows, m, ROW_B);
  Real b1 = PC_LD(contact_rows, m, ROW_B + 1u);
  Real b2 = PC_LD(contact_rows, m, ROW_B + 2u);
  Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
  Real m0 = PC_LD(contact_rows, m, ROW_MASS);
  Real m1 = PC_LD(contact_rows, m, ROW_MASS + 1u);
  Real m2 = PC_LD(contact_rows, m, ROW_MASS + 2u);
  Real m3 = PC_LD(contact_rows, m, ROW_MASS + 3u);
  Real o0 = pc_inverse_or_zero(m0);
  Real o1 = pc_inverse_or_zero(m1);
  Real o2 = pc_inverse_or_zero(m2);
  Real o3 = pc_inverse_or_zero(m3);
  Real w2 = pc_select(m2 > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  Real w3 = pc_select(m3 > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  precise Real d02 = PC_LD(contact_rows, m, ROW_D + 1u) * w2;
  precise Real d03 = PC_LD(contact_rows, m, ROW_D + 2u) * w3;
  precise Real d12 = PC_LD(contact_rows, m, ROW_D + 3u) * w2;
  precise Real d13 = PC_LD(contact_rows, m, ROW_D + 4u) * w3;
  precise Real d23 = PC_LD(contact_rows, m, ROW_D + 5u) * w3;
  Real d01 = PC_LD(contact_rows, m, ROW_D);
  Real p0 = pc_pace(o0, d01, d02, d03);
  Real p1 = pc_pace(o1, d01, d12, d13);
  Real p2 = pc_pace(o2, d02, d12, d23);
  Real p3 = pc_pace(o3, d03, d13, d23);
  Real l0 = PC_LD(contact_impulses, m, 0u);
  Real l1 = PC_LD(contact_impulses, m, 1u);
  Real l2 = PC_LD(contact_impulses, m, 2u);
  Real l3 = PC_LD(contact_impulses, m, 3u);
  Real k0 = l0;
  Real k1 = l1;
  Real k2 = l2;
  Real k3 = l3;
  Friction f = r.f;
  for (uint k = 0u; k < SETTLE_ROUNDS; k++) {
    Real vn = f.after.vn;
    Real w1 = f.after.w1;
    Real w2 = f.after.w2;
    precise Real e0 = k0 - l0;
    precise Real e1 = k1 - l1;
    precise Real e2 = k2 - l2;
    precise Real e3 = k3 - l3;
    precise Real v0 = vn + b0 * w1 - a0 * w2 + (o0 * e0 + d01 * e1 + d02 * e2 + d03 * e3);
    precise Real v1 = vn + b1 * w1 - a1 * w2 + (o1 * e1 + d01 * e0 + d12 * e2 + d13 * e3);
    precise Real v2 = vn + b2 * w1 - a2 * w2 + (o2 * e2 + d02 * e0 + d12 * e1 + d23 * e3);
    precise Real v3 = vn + b3 * w1 - a3 * w2 + (o3 * e3 + d03 * e0 + d13 * e1 + d23 * e2);
    k0 = pc_settled_row(PC_PASS v0, gap.s0, m0, k0, p0, loose);
    k1 = pc_settled_row(PC_PASS v1, gap.s1, m1, k1, p1, loose);
    k2 = pc_settled_row(PC_PASS v2, gap.s2, m2, k2, p2, loose);
    k3 = pc_settled_row(PC_PASS v3, gap.s3, m3, k3, p3, loose);

    precise Real n0 = k0 - l0;
    precise Real n1 = k1 - l1;
    precise Real n2 = k2 - l2;
    precise Real n3 = k3 - l3;
    Push push = pc_push(PC_PASS m, n0, n1, n2, n3);
    precise Real load = k0 + k1 + k2 + k3;
    f = pc_friction(PC_PASS m, pc_pushed_twist(PC_PASS m, v, push), load);
  }
  r.k0 = pc_select(unsettled, k0, r.k0);
  r.k1 = pc_select(unsettled, k1, r.k1);
  r.k2 = pc_select(unsettled, k2, r.k2);
  r.k3 = pc_select(unsettled, k3, r.k3);
  r.f.next1 = pc_select(unsettled, f.next1, r.f.next1);
  r.f.next2 = pc_select(unsettled, f.next2, r.f.next2);
  r.f.next_twist = pc_select(unsettled, f.next_twist, r.f.next_twist);
  r.f.change1 = pc_select(unsettled, f.change1, r.f.change1);
  r.f.change2 = pc_select(unsettled, f.change2, r.f.change2);
  r.f.change_twist = pc_select(unsettled, f.change_twist, r.f.change_twist);
}
