// Stub: general convex pairs follow.
PC_FN_LARGE void pc_convex(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(uint) hint, PC_INOUT(NarrowManifold) m) {
  if (a.kind == b.kind && margin < PC_REAL(0.0)) hint = 0u;
  m.count = 0u;
}
