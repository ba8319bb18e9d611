// Relative normal velocity of a row's point: below 0 it approaches.
PC_FN Real pc_row_approach(PC_IO Slot m, uint i, Twist v) {
  Real a = PC_LD(contact_rows, m, ROW_A + i);
  Real b = PC_LD(contact_rows, m, ROW_B + i);
  precise Real u = v.vn + b * v.w1 - a * v.w2;
  return u;
}
