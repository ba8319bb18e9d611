// A manifold whose load has just come, or whose friction has just let go: its rows are solved together, by further rounds of
// friction and normal rows. One round a visit is enough where the last sub-step's impulses still hold; here they do not, and what
// one round leaves (a box that tilts a little, and slides while it does) is never undone.
struct Gaps { Real s0; Real s1; Real s2; Real s3; };
struct Rows { Real k0; Real k1; Real k2; Real k3; Friction f; };

// Whether rounds are needed: more than one point, and a load half as large again as what holds, or friction that changes by a
// tenth of its limit.
PC_FN Mask pc_unsettled(PC_IO Slot m, Real load, Real coming, Friction f) {
  precise Real more = coming - load * PC_REAL(1.5);
  precise Real change = f.change1 * f.change1 + f.change2 * f.change2; precise Real limit = coming * PC_LD(contact_rows, m, ROW_MU_KINETIC) * PC_REAL(0.1); precise Real square = limit * limit;
  return pc_and(PC_LD(contact_rows, m, ROW_MASS + 1u) > PC_REAL(0.0), pc_or(more > PC_REAL(0.0), change > square));
}

// One row of a round: `v` is what the point's velocity would be did its own row not change.
PC_FN Real pc_settled_row(PC_IO Real v, Real s, Real own, Real mass, Real before, Real now, Real mean) {
  precise Real change = now - before; precise Real felt = v + own * change;
  return pc_normal_row(PC_PASS felt, s, mass, now, mean);
}

// `v`: the twist before the visit; `r`: impulses after its first round.
PC_FN void pc_settle(PC_IO Slot m, Twist v, Gaps gap, Real mass_scale, Mask unsettled, PC_INOUT(Rows) r) {
  Real a0 = PC_LD(contact_rows, m, ROW_A); Real a1 = PC_LD(contact_rows, m, ROW_A + 1u); Real a2 = PC_LD(contact_rows, m, ROW_A + 2u); Real a3 = PC_LD(contact_rows, m, ROW_A + 3u);
  Real b0 = PC_LD(contact_rows, m, ROW_B); Real b1 = PC_LD(contact_rows, m, ROW_B + 1u); Real b2 = PC_LD(contact_rows, m, ROW_B + 2u); Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
  Real d01 = PC_LD(contact_rows, m, ROW_D); Real d02 = PC_LD(contact_rows, m, ROW_D + 1u); Real d03 = PC_LD(contact_rows, m, ROW_D + 2u);
  Real d12 = PC_LD(contact_rows, m, ROW_D + 3u); Real d13 = PC_LD(contact_rows, m, ROW_D + 4u); Real d23 = PC_LD(contact_rows, m, ROW_D + 5u);
  Real l0 = PC_LD(contact_impulses, m, 0u); Real l1 = PC_LD(contact_impulses, m, 1u); Real l2 = PC_LD(contact_impulses, m, 2u); Real l3 = PC_LD(contact_impulses, m, 3u);
  Real q0 = PC_LD(contact_rows, m, ROW_MASS); Real q1 = PC_LD(contact_rows, m, ROW_MASS + 1u); Real q2 = PC_LD(contact_rows, m, ROW_MASS + 2u); Real q3 = PC_LD(contact_rows, m, ROW_MASS + 3u);
  Real o0 = pc_inverse_or_zero(q0); Real o1 = pc_inverse_or_zero(q1); Real o2 = pc_inverse_or_zero(q2); Real o3 = pc_inverse_or_zero(q3);
  precise Real m0 = q0 * mass_scale; precise Real m1 = q1 * mass_scale; precise Real m2 = q2 * mass_scale; precise Real m3 = q3 * mass_scale;
  Real k0 = r.k0; Real k1 = r.k1; Real k2 = r.k2; Real k3 = r.k3; Friction f = r.f;
  for (uint round = 1u; round < 16u; round++) {
    precise Real e0 = k0 - l0; precise Real e1 = k1 - l1; precise Real e2 = k2 - l2; precise Real e3 = k3 - l3;
    Push push = pc_push(PC_PASS m, e0, e1, e2, e3);
    // by symmetry the responses of sliding and twist to the normal rows are those of the rows to them
    precise Real t1 = v.v1 + (PC_LD(contact_rows, m, ROW_C) * push.n + PC_LD(contact_rows, m, ROW_C + 3u) * push.m1 + PC_LD(contact_rows, m, ROW_C + 6u) * push.m2);
    precise Real t2 = v.v2 + (PC_LD(contact_rows, m, ROW_C + 1u) * push.n + PC_LD(contact_rows, m, ROW_C + 4u) * push.m1 + PC_LD(contact_rows, m, ROW_C + 7u) * push.m2);
    precise Real tn = v.wn + (PC_LD(contact_rows, m, ROW_C + 2u) * push.n + PC_LD(contact_rows, m, ROW_C + 5u) * push.m1 + PC_LD(contact_rows, m, ROW_C + 8u) * push.m2);
    Twist felt = v; felt.v1 = t1; felt.v2 = t2; felt.wn = tn;
    precise Real load = k0 + k1 + k2 + k3;
    f = pc_friction(PC_PASS m, felt, load, mass_scale);
    Real vn = f.after.vn; Real w1 = f.after.w1; Real w2 = f.after.w2;
    precise Real v0 = vn + b0 * w1 - a0 * w2 + d01 * e1 + d02 * e2 + d03 * e3;
    k0 = pc_settled_row(PC_PASS v0, gap.s0, o0, m0, l0, k0, pc_mean(0u)); precise Real n0 = k0 - l0;
    precise Real v1 = vn + b1 * w1 - a1 * w2 + d01 * n0 + d12 * e2 + d13 * e3;
    k1 = pc_settled_row(PC_PASS v1, gap.s1, o1, m1, l1, k1, pc_mean(1u)); precise Real n1 = k1 - l1;
    precise Real v2 = vn + b2 * w1 - a2 * w2 + d02 * n0 + d12 * n1 + d23 * e3;
    k2 = pc_settled_row(PC_PASS v2, gap.s2, o2, m2, l2, k2, pc_mean(2u)); precise Real n2 = k2 - l2;
    precise Real v3 = vn + b3 * w1 - a3 * w2 + d03 * n0 + d13 * n1 + d23 * n2;
    k3 = pc_settled_row(PC_PASS v3, gap.s3, o3, m3, l3, k3, pc_mean(3u));
  }
  r.k0 = pc_select(unsettled, k0, r.k0); r.k1 = pc_select(unsettled, k1, r.k1); r.k2 = pc_select(unsettled, k2, r.k2); r.k3 = pc_select(unsettled, k3, r.k3);
  r.f.next1 = pc_select(unsettled, f.next1, r.f.next1); r.f.next2 = pc_select(unsettled, f.next2, r.f.next2); r.f.next_twist = pc_select(unsettled, f.next_twist, r.f.next_twist);
  r.f.change1 = pc_select(unsettled, f.change1, r.f.change1); r.f.change2 = pc_select(unsettled, f.change2, r.f.change2); r.f.change_twist = pc_select(unsettled, f.change_twist, r.f.change_twist);
}
