// Start of a sub-step's impulses: the impulses of the last sub-step act again (warm start), at today's arms.
#include "contact_rows.inl"
#include "contact_response.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u); Index ib = PC_ENDS(contact_ends, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u); Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N); Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T); Vec3 t2 = pc_cross(n, t1);
  Push push = pc_push(PC_PASS m, PC_LD(contact_impulses, m, 0u), PC_LD(contact_impulses, m, 1u), PC_LD(contact_impulses, m, 2u), PC_LD(contact_impulses, m, 3u));
  Real f1 = PC_LD(contact_impulses, m, IMPULSE_T); Real f2 = PC_LD(contact_impulses, m, IMPULSE_T + 1u); Real twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u);
  pc_apply(PC_PASS ia, ib, a, b, arms, pc_combine(t1, f1, t2, f2, n, push.n), pc_combine(t1, push.m1, t2, push.m2, n, twist));
}
