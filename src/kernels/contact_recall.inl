// What contacts remember, summed up on each body before it acts (recall_share.inl).
#include "contact_rows.inl"
#include "contact_lasting.inl"

PC_FN void pc_recall(PC_IO Index i, Vec3 impulse) {
  Quad sum = PC_GATHER(recalled, i, 0u);
  Mask moves = PC_GATHER(motion, i, 0u).s > PC_REAL(0.0);
  PC_SCATTER_IF(moves, recalled, i, 0u, pc_quad(pc_snap3(pc_add(sum.v, impulse)), sum.s));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Lasting l = pc_lasting(PC_PASS m);
  Mask some = l.load > PC_REAL(0.0);
  if (!PC_ANY(some)) return;  // lint: allow (nothing changes nothing)
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  precise Real load = l.l0 + l.l1 + l.l2 + l.l3;
#ifdef PC_FRICTIONLESS
  Vec3 impulse = pc_scale(n, load);
#else
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  precise Real f1 = PC_LD(contact_impulses, m, IMPULSE_T) * l.share;
  precise Real f2 = PC_LD(contact_impulses, m, IMPULSE_T + 1u) * l.share;
  Vec3 impulse = pc_combine(t1, f1, pc_cross(n, t1), f2, n, load);
#endif
  impulse = pc_select3(some, impulse, pc_zero3());
  pc_recall(PC_PASS PC_ENDS(contact_ends, m, 0u), pc_negate(impulse));
  pc_recall(PC_PASS PC_ENDS(contact_ends, m, 1u), impulse);
}
