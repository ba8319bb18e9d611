// How the separations changed since the start of the step: of the centre, and by how the bodies turned.
struct Shift {
  Real n;
  Real turn1;
  Real turn2;
};
PC_FN Shift pc_shift_of(PC_IO Slot m, Vec3 n, Vec3 t1, Vec3 t2, Quad moved_a, Quad moved_b, Quad turned_a,
                        Quad turned_b) {
  Vec3 shift_a = pc_add(moved_a.v, pc_cross(turned_a.v, pc_ld3_rows(PC_PASS m, ROW_ARM_A)));
  Vec3 shift_b = pc_add(moved_b.v, pc_cross(turned_b.v, pc_ld3_rows(PC_PASS m, ROW_ARM_B)));
  Vec3 turn = pc_sub(turned_b.v, turned_a.v);
  Shift s;
  s.n = pc_dot(n, pc_sub(shift_b, shift_a));
  s.turn1 = pc_dot(t1, turn);
  s.turn2 = pc_dot(t2, turn);
  return s;
}
