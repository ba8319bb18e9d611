// The share of what a contact remembers that acts: the lesser of its two bodies' (recall_share.inl).
PC_FN Real pc_recalled_of(PC_IO Index i) {
  Mask moves = PC_GATHER(motion, i, 0u).s > PC_REAL(0.0);
  return pc_select(moves, PC_GATHER(delta, i, 2u).v.z, PC_REAL(1.0));
}
// (one of which all is kept stays as it is to the last bit, where lanes beside it do not)
PC_FN void pc_keep_share(PC_IO Slot m, Real share) {
  Mask less = share < PC_REAL(1.0);
  for (uint i = 0u; i < IMPULSES; i++) {
    Real before = PC_LD(contact_impulses, m, i);
    precise Real kept = before * share;
    PC_ST(contact_impulses, m, i, pc_select(less, pc_snap(kept), before));
  }
}
PC_FN void pc_keep_recalled(PC_IO Slot m, Index ia, Index ib, Mask these) {
  Real share = pc_select(these, pc_min(pc_recalled_of(PC_PASS ia), pc_recalled_of(PC_PASS ib)), PC_REAL(1.0));
  if (!PC_ANY(share < PC_REAL(1.0))) return;  // lint: allow (a share of one changes nothing)
  pc_keep_share(PC_PASS m, share);
}
