// Start of a sub-step's impulses: what lasts of the last ones acts again (warm start), at the present arms.
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_lasting.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u); Index ib = PC_ENDS(contact_ends, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u); Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms = pc_arms(PC_PASS m, a, b, moved_a.v, moved_b.v);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N); Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T); Vec3 t2 = pc_cross(n, t1);
  Lasting l = pc_lasting(PC_PASS m);
  PC_ST(contact_impulses, m, IMPULSE_BEFORE, l.load);
  PC_ST(contact_impulses, m, 0u, l.l0); PC_ST(contact_impulses, m, 1u, l.l1); PC_ST(contact_impulses, m, 2u, l.l2); PC_ST(contact_impulses, m, 3u, l.l3);
  precise Real f1 = PC_LD(contact_impulses, m, IMPULSE_T) * l.share; precise Real f2 = PC_LD(contact_impulses, m, IMPULSE_T + 1u) * l.share; precise Real twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u) * l.share;
  PC_ST(contact_impulses, m, IMPULSE_T, f1); PC_ST(contact_impulses, m, IMPULSE_T + 1u, f2); PC_ST(contact_impulses, m, IMPULSE_T + 2u, twist);
  Push push = pc_push(PC_PASS m, l.l0, l.l1, l.l2, l.l3);
  pc_apply(PC_PASS ia, ib, a, b, arms, pc_combine(t1, f1, t2, f2, n, push.n), pc_combine(t1, push.m1, t2, push.m2, n, twist));
}
