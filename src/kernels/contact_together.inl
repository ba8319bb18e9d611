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
