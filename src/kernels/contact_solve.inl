// Visits a manifold: friction at the centre, then the normal rows one after the other (Gauss-Seidel with
// accumulated impulses). The biased solve and the relax pass are this same text with other coefficients:
// relax has contact_rate 0, mass scale 1, impulse scale 0, so it removes the velocity that undoing an
// overlap put in (soft step: E. Catto, Solver2D, 2024).
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_friction.inl"

// New accumulated impulse of one normal row. Open rows (s > 0) are speculative: they stop what would close
// the gap within this sub-step. Closed ones push the overlap out, as a soft constraint.
PC_FN Real pc_normal_row(PC_IO Real vn, Real s, Real mass, Real impulse) {
  Mask open = s > PC_REAL(0.0);
  precise Real gap_rate = s * PC_INFO(inverse_h);
  precise Real soft_rate = s * PC_INFO(contact_rate);
  Real bias = pc_select(open, gap_rate, pc_max(soft_rate, -PC_INFO(push_speed)));
  Real mass_scale = pc_select(open, PC_REAL(1.0), PC_INFO(contact_mass_scale));
  Real impulse_scale = pc_select(open, PC_REAL(0.0), PC_INFO(contact_impulse_scale));
  precise Real next = impulse - mass * mass_scale * (vn + bias) - impulse_scale * impulse;
  // in the relax pass an open row that holds nothing waits for the sub-step in which it closes
  Mask waits = pc_and(pc_and(open, impulse < PC_TINY), PC_INFO(load_ahead) > PC_REAL(0.0));
  return pc_select(waits, PC_REAL(0.0), pc_snap(pc_max(next, PC_REAL(0.0))));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u); Index ib = PC_ENDS(contact_ends, m, 1u);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N); Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T); Vec3 t2 = pc_cross(n, t1);
  Quad moved_a = PC_GATHER(delta, ia, 0u); Quad moved_b = PC_GATHER(delta, ib, 0u); Quad turned_a = PC_GATHER(delta, ia, 1u); Quad turned_b = PC_GATHER(delta, ib, 1u);

  // how the separations changed since the start of the step
  Vec3 shift_a = pc_add(moved_a.v, pc_cross(turned_a.v, pc_ld3_rows(PC_PASS m, ROW_ARM_A)));
  Vec3 shift_b = pc_add(moved_b.v, pc_cross(turned_b.v, pc_ld3_rows(PC_PASS m, ROW_ARM_B)));
  Vec3 turn = pc_sub(turned_b.v, turned_a.v);
  Real shift_n = pc_dot(n, pc_sub(shift_b, shift_a)); Real turn1 = pc_dot(t1, turn); Real turn2 = pc_dot(t2, turn);

  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v); Real mass_scale = PC_LD(contact_rows, m, ROW_SCALE);
  Twist v = pc_twist(a, b, arms, n, t1, t2);
  Real l0 = PC_LD(contact_impulses, m, 0u); Real l1 = PC_LD(contact_impulses, m, 1u); Real l2 = PC_LD(contact_impulses, m, 2u); Real l3 = PC_LD(contact_impulses, m, 3u);

  precise Real load = l0 + l1 + l2 + l3;
  // the soft rows have let go of a share of the load, which the rigid ones of the relax pass will take up again
  precise Real coming = load - v.vn * pc_inverse_or_zero(PC_LD(contact_rows, m, ROW_K)) * mass_scale * PC_INFO(load_ahead);
  Friction f = pc_friction(PC_PASS m, v, pc_select(load > PC_REAL(0.0), pc_max(coming, PC_REAL(0.0)), load), mass_scale);
  PC_ST(contact_impulses, m, IMPULSE_T, f.next1); PC_ST(contact_impulses, m, IMPULSE_T + 1u, f.next2); PC_ST(contact_impulses, m, IMPULSE_T + 2u, f.next_twist);
  Real vn = f.after.vn; Real w1 = f.after.w1; Real w2 = f.after.w2;

  // normal rows
  Real a0 = PC_LD(contact_rows, m, ROW_A); Real b0 = PC_LD(contact_rows, m, ROW_B);
  precise Real v0 = vn + b0 * w1 - a0 * w2;
  precise Real s0 = PC_LD(contact_rows, m, ROW_S) + (shift_n + b0 * turn1 - a0 * turn2);
  precise Real m0 = PC_LD(contact_rows, m, ROW_MASS) * mass_scale; Real k0 = pc_normal_row(PC_PASS v0, s0, m0, l0); precise Real e0 = k0 - l0;
  PC_ST(contact_impulses, m, 0u, k0); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 0u, pc_max(PC_LD(contact_impulses, m, IMPULSE_LARGEST + 0u), k0));
  Real a1 = PC_LD(contact_rows, m, ROW_A + 1u); Real b1 = PC_LD(contact_rows, m, ROW_B + 1u);
  precise Real v1 = vn + b1 * w1 - a1 * w2 + PC_LD(contact_rows, m, ROW_D + 0u) * e0;
  precise Real s1 = PC_LD(contact_rows, m, ROW_S + 1u) + (shift_n + b1 * turn1 - a1 * turn2);
  precise Real m1 = PC_LD(contact_rows, m, ROW_MASS + 1u) * mass_scale; Real k1 = pc_normal_row(PC_PASS v1, s1, m1, l1); precise Real e1 = k1 - l1;
  PC_ST(contact_impulses, m, 1u, k1); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 1u, pc_max(PC_LD(contact_impulses, m, IMPULSE_LARGEST + 1u), k1));
  Real a2 = PC_LD(contact_rows, m, ROW_A + 2u); Real b2 = PC_LD(contact_rows, m, ROW_B + 2u);
  precise Real v2 = vn + b2 * w1 - a2 * w2 + PC_LD(contact_rows, m, ROW_D + 1u) * e0 + PC_LD(contact_rows, m, ROW_D + 3u) * e1;
  precise Real s2 = PC_LD(contact_rows, m, ROW_S + 2u) + (shift_n + b2 * turn1 - a2 * turn2);
  precise Real m2 = PC_LD(contact_rows, m, ROW_MASS + 2u) * mass_scale; Real k2 = pc_normal_row(PC_PASS v2, s2, m2, l2); precise Real e2 = k2 - l2;
  PC_ST(contact_impulses, m, 2u, k2); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 2u, pc_max(PC_LD(contact_impulses, m, IMPULSE_LARGEST + 2u), k2));
  Real a3 = PC_LD(contact_rows, m, ROW_A + 3u); Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
  precise Real v3 = vn + b3 * w1 - a3 * w2 + PC_LD(contact_rows, m, ROW_D + 2u) * e0 + PC_LD(contact_rows, m, ROW_D + 4u) * e1 + PC_LD(contact_rows, m, ROW_D + 5u) * e2;
  precise Real s3 = PC_LD(contact_rows, m, ROW_S + 3u) + (shift_n + b3 * turn1 - a3 * turn2);
  precise Real m3 = PC_LD(contact_rows, m, ROW_MASS + 3u) * mass_scale; Real k3 = pc_normal_row(PC_PASS v3, s3, m3, l3); precise Real e3 = k3 - l3;
  PC_ST(contact_impulses, m, 3u, k3); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 3u, pc_max(PC_LD(contact_impulses, m, IMPULSE_LARGEST + 3u), k3));

  precise Real pressed = k0 + k1 + k2 + k3; Real touch = pc_max(load, pressed);
  // a fixed body's row stays as it is: slots beside each other may share it, and GL does not store it
  a.phase = pc_select(a.inverse_mass > PC_REAL(0.0), pc_max(a.phase, touch), a.phase); b.phase = pc_select(b.inverse_mass > PC_REAL(0.0), pc_max(b.phase, touch), b.phase);
  Push push = pc_push(PC_PASS m, e0, e1, e2, e3);
  pc_apply(PC_PASS ia, ib, a, b, arms, pc_combine(t1, f.change1, t2, f.change2, n, push.n), pc_combine(t1, push.m1, t2, push.m2, n, f.change_twist));
}
