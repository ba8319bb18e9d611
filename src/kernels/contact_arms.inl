// The bodies have moved apart by D since the rows were found, so the two frozen arms end D apart, and
// equal and opposite impulses there would exert a couple D x F. Both arms are therefore drawn to one common
// point, in inverse proportion to the masses: on a light body the point stays, on a heavy one it travels
// with the light one; a fixed body takes the whole shift.
struct Arms {
  Vec3 a;
  Vec3 b;
};
PC_FN Arms pc_arms(PC_IO Slot m, Vec3 moved_a, Vec3 moved_b) {
  Vec3 d = pc_sub(pc_sub(moved_b, moved_a), pc_ld3_rows(PC_PASS m, ROW_PATH));
  Real share = PC_LD(contact_rows, m, ROW_SHARE);
  precise Real rest = share - PC_REAL(1.0);
  Arms r;
  r.a = pc_madd(pc_ld3_rows(PC_PASS m, ROW_ARM_A), d, share);
  r.b = pc_madd(pc_ld3_rows(PC_PASS m, ROW_ARM_B), d, rest);
  return r;
}
