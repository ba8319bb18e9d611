// Numbers without a name.
#define PC_SHARE PC_REAL(0.3)
#define PC_TIMES_THREE(x) pc_share_of(x, PC_REAL(3.0))  // expect: bare
PC_FN Real pc_bare(Real a) {
  precise Real half_of = a * PC_REAL(0.5) + PC_REAL(1.0) - PC_REAL(2.0) * PC_REAL(0.0);
  precise Real quarter = half_of * PC_REAL(0.25);  // expect: bare
  precise Real named = quarter * PC_SHARE;
  Mask small = named < PC_REAL(-1e-6);         // expect: bare
  return pc_select(small, PC_REAL(1), named);  // expect: bare
}
