#include "contact_lasting.inl"

// Lets the manifold's impulses last, and gives what they exert on b at its centre.
struct Wrench { Vec3 impulse; Vec3 couple; };
PC_FN Wrench pc_warm_start(PC_IO Slot m) {
  Lasting l = pc_lasting(PC_PASS m);
  PC_ST(contact_impulses, m, IMPULSE_BEFORE, l.load);
  PC_ST(contact_impulses, m, 0u, l.l0); PC_ST(contact_impulses, m, 1u, l.l1); PC_ST(contact_impulses, m, 2u, l.l2); PC_ST(contact_impulses, m, 3u, l.l3);
  precise Real f1 = PC_LD(contact_impulses, m, IMPULSE_T) * l.share; precise Real f2 = PC_LD(contact_impulses, m, IMPULSE_T + 1u) * l.share; precise Real twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u) * l.share;
  PC_ST(contact_impulses, m, IMPULSE_T, f1); PC_ST(contact_impulses, m, IMPULSE_T + 1u, f2); PC_ST(contact_impulses, m, IMPULSE_T + 2u, twist);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N); Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T); Vec3 t2 = pc_cross(n, t1);
  Push push = pc_push(PC_PASS m, l.l0, l.l1, l.l2, l.l3);
  Wrench w; w.impulse = pc_combine(t1, f1, t2, f2, n, push.n); w.couple = pc_combine(t1, push.m1, t2, push.m2, n, twist); return w;
}
