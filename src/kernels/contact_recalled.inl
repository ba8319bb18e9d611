// The share of what a contact remembers that acts: the lesser of its two bodies' (recall_share.inl).
PC_FN Real pc_recalled_of(PC_IO Index i) {
  Mask moves = PC_GATHER(motion, i, 0u).s > PC_REAL(0.0);
  return pc_select(moves, PC_GATHER(delta, i, 2u).v.z, PC_REAL(1.0));
}
PC_FN void pc_keep_share(PC_IO Slot m, Real share) {
  for (uint i = 0u; i < IMPULSES; i++) {
    precise Real kept = PC_LD(contact_impulses, m, i) * share;
    PC_ST(contact_impulses, m, i, pc_snap(kept));
  }
}
PC_FN void pc_keep_recalled(PC_IO Slot m, Index ia, Index ib) {
  Real share = pc_min(pc_recalled_of(PC_PASS ia), pc_recalled_of(PC_PASS ib));
  if (!PC_ANY(share < PC_REAL(1.0))) return;  // lint: allow (a share of one changes nothing)
  pc_keep_share(PC_PASS m, share);
}
