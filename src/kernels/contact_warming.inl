#include "contact_lasting.inl"

PC_FN void pc_st_last(PC_IO Slot m, Mask these, uint i, Real x) {
  PC_ST(contact_impulses, m, i, pc_select(these, x, PC_LD(contact_impulses, m, i)));
}
// Lets the impulses of these manifolds last, and gives what they exert on b at its centre.
PC_FN Wrench pc_warm_start(PC_IO Slot m, Mask these) {
  Lasting l = pc_lasting(PC_PASS m);
  pc_st_last(PC_PASS m, these, IMPULSE_BEFORE, l.load);
  pc_st_last(PC_PASS m, these, 0u, l.l0);
  pc_st_last(PC_PASS m, these, 1u, l.l1);
  pc_st_last(PC_PASS m, these, 2u, l.l2);
  pc_st_last(PC_PASS m, these, 3u, l.l3);
#ifdef PC_FRICTIONLESS
  Real f1 = PC_REAL(0.0);
  Real f2 = PC_REAL(0.0);
  Real twist = PC_REAL(0.0);
#else
  precise Real f1 = PC_LD(contact_impulses, m, IMPULSE_T) * l.share;
  precise Real f2 = PC_LD(contact_impulses, m, IMPULSE_T + 1u) * l.share;
  precise Real twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u) * l.share;
  pc_st_last(PC_PASS m, these, IMPULSE_T, f1);
  pc_st_last(PC_PASS m, these, IMPULSE_T + 1u, f2);
  pc_st_last(PC_PASS m, these, IMPULSE_T + 2u, twist);
#endif
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  return pc_wrench(n, t1, t2, pc_push(PC_PASS m, l.l0, l.l1, l.l2, l.l3), f1, f2, twist);
}
