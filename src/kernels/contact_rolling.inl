// Rolling and torsional friction: a couple that resists turning across the normal by up to rolling_friction times the
// load, and about it by up to torsional_friction times the load (the larger of the two materials'). Stands before
// contact_solve, whose friction then answers for what the couple does to the sliding.
// The biased visit starts a sub-step from nothing, the relax visit adds to it: what stops all turning comes of itself.
#include "contact_rows.inl"
#include "body_state.inl"

PC_FN void pc_turned(PC_IO Index i, BodyState b, Vec3 couple, Real sign) {
  precise Real share = b.response * sign;
  PC_SCATTER_IF(b.inverse_mass > PC_REAL(0.0), motion, i, 1u, pc_quad(pc_madd(b.l, couple, share), b.phase));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
  Quad rough_a = PC_GATHER(material, ia, 1u);
  Quad rough_b = PC_GATHER(material, ib, 1u);
  precise Real load = PC_LD(contact_impulses, m, 0u) + PC_LD(contact_impulses, m, 1u) + PC_LD(contact_impulses, m, 2u) +
                      PC_LD(contact_impulses, m, 3u);
  precise Real roll_limit = pc_max(rough_a.v.x, rough_b.v.x) * load;
  precise Real twist_limit = pc_max(rough_a.v.y, rough_b.v.y) * load;
  Real zero = PC_REAL(0.0);
  Mask adds = PC_INFO(load_ahead) > PC_REAL(0.5);
  Real r1 = pc_select(adds, PC_LD(rolling_impulses, m, 0u), zero);
  Real r2 = pc_select(adds, PC_LD(rolling_impulses, m, 1u), zero);
  Real rt = pc_select(adds, PC_LD(rolling_impulses, m, 2u), zero);

  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Sym3 both = pc_sym_add(pc_responding_inertia(a), pc_responding_inertia(b));
  Vec3 w = pc_sub(pc_angular_velocity(b), pc_angular_velocity(a));
  Real w1 = pc_dot(t1, w);
  Real w2 = pc_dot(t2, w);
  Real wn = pc_dot(n, w);
  Vec3 k1 = pc_sym_mul(both, t1);
  Vec3 k2 = pc_sym_mul(both, t2);
  Vec3 kn = pc_sym_mul(both, n);
  Real k11 = pc_dot(t1, k1);
  Real k12 = pc_dot(t1, k2);
  Real k22 = pc_dot(t2, k2);
  precise Real det = k11 * k22 - k12 * k12;
  Real inverse_det = pc_inverse_or_zero(det);

  precise Real g1 = r1 - (k22 * w1 - k12 * w2) * inverse_det;
  precise Real g2 = r2 - (k11 * w2 - k12 * w1) * inverse_det;
  precise Real size = g1 * g1 + g2 * g2;
  precise Real most = roll_limit * roll_limit;
  Mask rolls = size > most;
  Real scale = pc_select(rolls, pc_div(roll_limit, pc_sqrt(pc_select(rolls, size, PC_REAL(1.0)))), PC_REAL(1.0));
  precise Real h1 = g1 * scale;
  precise Real h2 = g2 * scale;
  Real next1 = pc_snap(h1);
  Real next2 = pc_snap(h2);
  precise Real c1 = next1 - r1;
  precise Real c2 = next2 - r2;
  precise Real spin = wn + (pc_dot(n, k1) * c1 + pc_dot(n, k2) * c2);
  precise Real gt = rt - spin * pc_inverse_or_zero(pc_dot(n, kn));
  Real next_twist = pc_snap(pc_clamp(gt, -twist_limit, twist_limit));
  precise Real ct = next_twist - rt;

  PC_ST(rolling_impulses, m, 0u, next1);
  PC_ST(rolling_impulses, m, 1u, next2);
  PC_ST(rolling_impulses, m, 2u, next_twist);
  PC_ST(rolling_impulses, m, 3u, zero);
  Vec3 couple = pc_combine(t1, c1, t2, c2, n, ct);
  pc_turned(PC_PASS ia, a, couple, PC_REAL(-1.0));
  pc_turned(PC_PASS ib, b, couple, PC_REAL(1.0));
}
