// One visit of a manifold's rows: friction at the centre, then the normal rows one after the other (Gauss-Seidel with
// accumulated impulses), from the relative twist at its centre to the change of its impulses.
#include "contact_friction.inl"
#include "contact_shift.inl"

// New accumulated impulse of one normal row. Open rows (s > 0) are speculative: they stop what would close
// the gap within this sub-step. Closed ones push the overlap out, as a soft constraint, whose leak acts on what deviates
// from a slow mean (PC_MEAN; else on the whole impulse): what rests is not pressed in (docs/joint-trees.md).
#ifdef PC_MEAN
#define pc_mean(i) PC_LD(contact_impulses, m, IMPULSE_MEAN + i)
#define pc_soft_rate PC_INFO(tree_contact_rate)
#define pc_soft_mass_scale PC_INFO(tree_contact_mass_scale)
#define pc_soft_impulse_scale PC_INFO(tree_contact_impulse_scale)
#else
#define pc_mean(i) PC_REAL(0.0)
#define pc_soft_rate PC_INFO(contact_rate)
#define pc_soft_mass_scale PC_INFO(contact_mass_scale)
#define pc_soft_impulse_scale PC_INFO(contact_impulse_scale)
#endif
PC_FN Real pc_normal_row(PC_IO Real vn, Real s, Real mass, Real impulse, Real mean) {
  Mask open = s > PC_REAL(0.0);
#ifdef PC_MEAN
  precise Real gap_rate = s * PC_INFO(inverse_h);
  precise Real soft_rate = s * PC_INFO(tree_contact_rate);
  Real bias = pc_select(open, gap_rate, pc_max(soft_rate, -PC_INFO(push_speed)));
  Real mass_scale = pc_select(open, PC_REAL(1.0), pc_soft_mass_scale);
  Real impulse_scale = pc_select(open, PC_REAL(0.0), pc_soft_impulse_scale);
  precise Real next = impulse - mass * mass_scale * (vn + bias) - impulse_scale * (impulse - mean);
#else
  precise Real gap_rate = s * PC_INFO(inverse_h);
  precise Real push_rate = s * pc_soft_rate;
  Real bias = pc_select(open, gap_rate, push_rate);
  precise Real scaled = mass * pc_select(open, PC_REAL(1.0), pc_soft_mass_scale);
  Real impulse_scale = pc_select(open, PC_REAL(0.0), pc_soft_impulse_scale);
  // (what the row lets go of and what it pushes out, together no faster than push_speed: any load is held)
  precise Real give = scaled * bias + impulse_scale * (impulse - mean); precise Real most = mass * PC_INFO(push_speed);
  precise Real next = impulse - scaled * vn - pc_max(give, -most);
#endif
  // in the relax pass an open row that holds nothing waits for the sub-step in which it closes
  Mask waits = pc_and(pc_and(open, impulse < PC_TINY), PC_INFO(load_ahead) > PC_REAL(0.0));
  return pc_select(waits, PC_REAL(0.0), pc_snap(pc_max(next, PC_REAL(0.0))));
}

// Impulse and couple on b at the centre, and the load before or after, whichever is larger.
struct Visit { Vec3 impulse; Vec3 couple; Real touch; };
PC_FN Visit pc_visit(PC_IO Slot m, Twist v, Shift shift, Vec3 n, Vec3 t1, Vec3 t2) {
  Real mass_scale = PC_LD(contact_rows, m, ROW_SCALE);
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
  precise Real s0 = PC_LD(contact_rows, m, ROW_S) + (shift.n + b0 * shift.turn1 - a0 * shift.turn2);
  precise Real m0 = PC_LD(contact_rows, m, ROW_MASS) * mass_scale; Real k0 = pc_normal_row(PC_PASS v0, s0, m0, l0, pc_mean(0u)); precise Real e0 = k0 - l0;
  PC_ST(contact_impulses, m, 0u, k0); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 0u, pc_max(PC_LD(contact_impulses, m, IMPULSE_LARGEST + 0u), k0));
  Real a1 = PC_LD(contact_rows, m, ROW_A + 1u); Real b1 = PC_LD(contact_rows, m, ROW_B + 1u);
  precise Real v1 = vn + b1 * w1 - a1 * w2 + PC_LD(contact_rows, m, ROW_D + 0u) * e0;
  precise Real s1 = PC_LD(contact_rows, m, ROW_S + 1u) + (shift.n + b1 * shift.turn1 - a1 * shift.turn2);
  precise Real m1 = PC_LD(contact_rows, m, ROW_MASS + 1u) * mass_scale; Real k1 = pc_normal_row(PC_PASS v1, s1, m1, l1, pc_mean(1u)); precise Real e1 = k1 - l1;
  PC_ST(contact_impulses, m, 1u, k1); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 1u, pc_max(PC_LD(contact_impulses, m, IMPULSE_LARGEST + 1u), k1));
  Real a2 = PC_LD(contact_rows, m, ROW_A + 2u); Real b2 = PC_LD(contact_rows, m, ROW_B + 2u);
  precise Real v2 = vn + b2 * w1 - a2 * w2 + PC_LD(contact_rows, m, ROW_D + 1u) * e0 + PC_LD(contact_rows, m, ROW_D + 3u) * e1;
  precise Real s2 = PC_LD(contact_rows, m, ROW_S + 2u) + (shift.n + b2 * shift.turn1 - a2 * shift.turn2);
  precise Real m2 = PC_LD(contact_rows, m, ROW_MASS + 2u) * mass_scale; Real k2 = pc_normal_row(PC_PASS v2, s2, m2, l2, pc_mean(2u)); precise Real e2 = k2 - l2;
  PC_ST(contact_impulses, m, 2u, k2); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 2u, pc_max(PC_LD(contact_impulses, m, IMPULSE_LARGEST + 2u), k2));
  Real a3 = PC_LD(contact_rows, m, ROW_A + 3u); Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
  precise Real v3 = vn + b3 * w1 - a3 * w2 + PC_LD(contact_rows, m, ROW_D + 2u) * e0 + PC_LD(contact_rows, m, ROW_D + 4u) * e1 + PC_LD(contact_rows, m, ROW_D + 5u) * e2;
  precise Real s3 = PC_LD(contact_rows, m, ROW_S + 3u) + (shift.n + b3 * shift.turn1 - a3 * shift.turn2);
  precise Real m3 = PC_LD(contact_rows, m, ROW_MASS + 3u) * mass_scale; Real k3 = pc_normal_row(PC_PASS v3, s3, m3, l3, pc_mean(3u)); precise Real e3 = k3 - l3;
  PC_ST(contact_impulses, m, 3u, k3); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 3u, pc_max(PC_LD(contact_impulses, m, IMPULSE_LARGEST + 3u), k3));

  precise Real pressed = k0 + k1 + k2 + k3;
  Push push = pc_push(PC_PASS m, e0, e1, e2, e3);
  Visit r; r.impulse = pc_combine(t1, f.change1, t2, f.change2, n, push.n); r.couple = pc_combine(t1, push.m1, t2, push.m2, n, f.change_twist);
  r.touch = pc_max(load, pressed); return r;
}
