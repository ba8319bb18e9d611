// Division and bare constants.
PC_FN Real pc_bad(Real a, Real b) {
  precise Real q = a / b;                      // expect: division
  precise Real r = PC_REAL(1.0) / q;           // expect: division
  precise Real halved = a * 0.5;               // expect: literal
  Real one = Real(1.0f);                       // expect: literal
  Real tiny = pc_select(a > 1e-9, r, halved);  // expect: literal
  Real x = a / b; /* lint: allow */            // expect: division expect: marker
  return a / one;                              // expect: division
}
