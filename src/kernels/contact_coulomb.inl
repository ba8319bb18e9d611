// Friction of a manifold at its centre: a 2 x 2 block for sliding, then a twist about the normal.
// While the impulse that stops all sliding is within mu_static times the load it acts whole, beyond that mu_kinetic
// times the load acts against the sliding (a circle, not a pyramid).
struct Friction {
  Real next1;
  Real next2;
  Real next_twist;
  Real change1;
  Real change2;
  Real change_twist;
  Twist after;
};

#ifdef PC_FRICTIONLESS
PC_FN Friction pc_no_friction(Twist v) {
  Real zero = PC_REAL(0.0);
  Friction r;
  r.next1 = zero;
  r.next2 = zero;
  r.next_twist = zero;
  r.change1 = zero;
  r.change2 = zero;
  r.change_twist = zero;
  r.after = v;
  return r;
}
PC_FN Friction pc_coulomb(PC_IO Slot m, Twist v, Real load, Real f1, Real f2, Real ft) { return pc_no_friction(v); }
#else
// f1, f2, ft: the impulses that act already.
PC_FN Friction pc_coulomb(PC_IO Slot m, Twist v, Real load, Real f1, Real f2, Real ft) {
  precise Real static_limit = load * PC_LD(contact_rows, m, ROW_MU_STATIC);
  precise Real kinetic_limit = load * PC_LD(contact_rows, m, ROW_MU_KINETIC);
  precise Real twist_limit = kinetic_limit * PC_LD(contact_rows, m, ROW_RADIUS);
  Real t12 = PC_LD(contact_rows, m, ROW_TT + 1u);
  precise Real g1 = f1 - (PC_LD(contact_rows, m, ROW_TT) * v.v1 + t12 * v.v2);
  precise Real g2 = f2 - (t12 * v.v1 + PC_LD(contact_rows, m, ROW_TT + 2u) * v.v2);
  precise Real gg = g1 * g1 + g2 * g2;
  precise Real limit_squared = static_limit * static_limit;
  Mask slides = gg > limit_squared;
  Real scale = pc_select(slides, pc_div(kinetic_limit, pc_sqrt(pc_select(slides, gg, PC_REAL(1.0)))), PC_REAL(1.0));
  precise Real kept1 = g1 * scale;
  precise Real kept2 = g2 * scale;
  Real h1 = pc_snap(kept1);
  Real h2 = pc_snap(kept2);
  precise Real c1 = h1 - f1;
  precise Real c2 = h2 - f2;
  precise Real wt = v.wn + (PC_LD(contact_rows, m, ROW_KW) * c1 + PC_LD(contact_rows, m, ROW_KW + 1u) * c2);
  precise Real gt = ft - PC_LD(contact_rows, m, ROW_TWIST) * wt;
  Real ht = pc_snap(pc_max(pc_min(gt, twist_limit), -twist_limit));
  precise Real ct = ht - ft;
  precise Real vn = v.vn + (PC_LD(contact_rows, m, ROW_C) * c1 + PC_LD(contact_rows, m, ROW_C + 1u) * c2 +
                            PC_LD(contact_rows, m, ROW_C + 2u) * ct);
  precise Real w1 = v.w1 + (PC_LD(contact_rows, m, ROW_C + 3u) * c1 + PC_LD(contact_rows, m, ROW_C + 4u) * c2 +
                            PC_LD(contact_rows, m, ROW_C + 5u) * ct);
  precise Real w2 = v.w2 + (PC_LD(contact_rows, m, ROW_C + 6u) * c1 + PC_LD(contact_rows, m, ROW_C + 7u) * c2 +
                            PC_LD(contact_rows, m, ROW_C + 8u) * ct);
  Friction r;
  r.next1 = h1;
  r.next2 = h2;
  r.next_twist = ht;
  r.change1 = c1;
  r.change2 = c2;
  r.change_twist = ct;
  r.after = v;
  r.after.vn = vn;
  r.after.w1 = w1;
  r.after.w2 = w2;
  return r;
}
#endif
