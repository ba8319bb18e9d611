// The normal rows of a manifold, all at once. Each asks for the change of its impulse that would stop its own point;
// all take the same share of what they ask for: the one that leaves least of it, by a line search along the whole. One
// after the other they would push a body to the side that comes last: towers walked off, and the mirror image of a
// scene did not move as the scene did.
struct FourRows {
  Real r0;
  Real r1;
  Real r2;
  Real r3;
};
PC_FN FourRows pc_four(Real r0, Real r1, Real r2, Real r3) {
  FourRows f;
  f.r0 = r0;
  f.r1 = r1;
  f.r2 = r2;
  f.r3 = r3;
  return f;
}
PC_FN FourRows pc_no_rows() { return pc_four(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0)); }
PC_FN FourRows pc_ld4_rows(PC_IO Slot m, uint f) {
  return pc_four(PC_LD(contact_rows, m, f), PC_LD(contact_rows, m, f + 1u), PC_LD(contact_rows, m, f + 2u),
                 PC_LD(contact_rows, m, f + 3u));
}
PC_FN FourRows pc_select4(Mask m, FourRows a, FourRows b) {
  return pc_four(pc_select(m, a.r0, b.r0), pc_select(m, a.r1, b.r1), pc_select(m, a.r2, b.r2),
                 pc_select(m, a.r3, b.r3));
}
PC_FN FourRows pc_sub4(FourRows a, FourRows b) {
  precise Real r0 = a.r0 - b.r0;
  precise Real r1 = a.r1 - b.r1;
  precise Real r2 = a.r2 - b.r2;
  precise Real r3 = a.r3 - b.r3;
  return pc_four(r0, r1, r2, r3);
}
PC_FN Real pc_sum4(FourRows a) {
  precise Real sum = a.r0 + a.r1 + a.r2 + a.r3;
  return sum;
}
PC_FN Real pc_largest4(FourRows a) { return pc_max(pc_max(a.r0, a.r1), pc_max(a.r2, a.r3)); }
PC_FN Real pc_smallest4(FourRows a) { return pc_min(pc_min(a.r0, a.r1), pc_min(a.r2, a.r3)); }
// Responses of one row to another.
struct Couplings {
  Real d01;
  Real d02;
  Real d03;
  Real d12;
  Real d13;
  Real d23;
};
PC_FN Couplings pc_couplings(PC_IO Slot m) {
  Couplings d;
  d.d01 = PC_LD(contact_rows, m, ROW_D);
  d.d02 = PC_LD(contact_rows, m, ROW_D + 1u);
  d.d03 = PC_LD(contact_rows, m, ROW_D + 2u);
  d.d12 = PC_LD(contact_rows, m, ROW_D + 3u);
  d.d13 = PC_LD(contact_rows, m, ROW_D + 4u);
  d.d23 = PC_LD(contact_rows, m, ROW_D + 5u);
  return d;
}

// now: impulses; change: what the rows ask for; mass: their effective masses, 0 where there is none. What would pull
// counts as far as it lets go. At most twice what they ask for: changes that no body feels (two corners up, two down)
// would be taken any number of times.
PC_FN Real pc_common_share(FourRows now, FourRows change, FourRows mass, Couplings d) {
  Real c0 = pc_max(change.r0, -now.r0);
  Real c1 = pc_max(change.r1, -now.r1);
  Real c2 = pc_max(change.r2, -now.r2);
  Real c3 = pc_max(change.r3, -now.r3);
  precise Real own = c0 * c0 * pc_inverse_or_zero(mass.r0) + c1 * c1 * pc_inverse_or_zero(mass.r1) +
                     c2 * c2 * pc_inverse_or_zero(mass.r2) + c3 * c3 * pc_inverse_or_zero(mass.r3);
  precise Real coupled = c0 * (c1 * d.d01 + c2 * d.d02 + c3 * d.d03) + c1 * (c2 * d.d12 + c3 * d.d13) + c2 * c3 * d.d23;
  precise Real whole = own + coupled * PC_REAL(2.0);
  precise Real best = own * pc_inverse_or_zero(whole);
  return pc_select(best > PC_REAL(0.0), pc_min(best, PC_REAL(2.0)), PC_REAL(1.0));
}
