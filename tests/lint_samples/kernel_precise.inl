// Arithmetic on reals outside the initialiser of a `precise` local.
#define PC_SQUARE(x) ((x) * (x))  // expect: precise
PC_FN Real pc_product(Real a, Real b) { return a * b; }  // expect: precise
PC_FN void pc_all(PC_IO Slot m, PC_INOUT(Vec3) v, Real a, Real b) {
  Real sum = a + b;  // expect: precise
  precise Real late;
  late = a - b;                               // expect: precise
  v.x += a;                                   // expect: precise
  v.y = v.y * a;                              // expect: precise
  precise Real inside = pc_max(a + b, b);     // expect: precise
  precise Real under = a * pc_sqrt(b - sum);  // expect: precise
  Mask over = a * b > sum;                    // expect: precise
  if (a + b > late) {  // expect: precise
    v.z = -v.z;
  }
  PC_ST(rows, 4u, m, 1u, a * inside);  // expect: precise
  Vec3 w = Vec3(a, b - a, under);      // expect: precise
  for (uint k = 0u; k < 2u; k++) {
    a *= b;  // expect: precise
  }
  a++;  // expect: precise
}
