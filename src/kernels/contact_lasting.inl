// What of a manifold's impulses lasts: as much as brings its load to no more than four times that of the sub-step
// before. A resting contact repeats itself and loses nothing. An impact came from nothing: repeating it would
// throw the body at its neighbours before its own row takes it back, and in a pile of bouncing bodies that
// feeds energy in. Where nothing bounces the rows' own losses take care of it, and the guess is worth more.
struct Lasting {
  Real l0;
  Real l1;
  Real l2;
  Real l3;
  Real load;
  Real share;
};
PC_FN Lasting pc_lasting(PC_IO Slot m) {
  Real k0 = PC_LD(contact_impulses, m, 0u);
  Real k1 = PC_LD(contact_impulses, m, 1u);
  Real k2 = PC_LD(contact_impulses, m, 2u);
  Real k3 = PC_LD(contact_impulses, m, 3u);
  precise Real load = k0 + k1 + k2 + k3;
  precise Real most = pc_four_times(PC_LD(contact_impulses, m, IMPULSE_BEFORE));
  precise Real less = most * pc_inverse_or_zero(load);
  Mask bounces = PC_LD(contact_rows, m, ROW_E) > PC_REAL(0.0);
  Real share = pc_select(bounces, pc_min(less, PC_REAL(1.0)), PC_REAL(1.0));
  precise Real l0 = k0 * share;
  precise Real l1 = k1 * share;
  precise Real l2 = k2 * share;
  precise Real l3 = k3 * share;
  Lasting r;
  r.l0 = l0;
  r.l1 = l1;
  r.l2 = l2;
  r.l3 = l3;
  r.load = load;
  r.share = share;
  return r;
}
