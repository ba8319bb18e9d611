// lint: allow-file (defines the division and the square root that kernels call)
// Correctly rounded division and square root, in three forms. The device probe picks for each function the
// first form that is exact on the device: _builtin, _fma (one fused correction step; P. Markstein, IA-64 and
// Elementary Functions, 2000), _nearest (the step, then the choice among three neighbours by exact
// residuals: near ties beside powers of four escape the step alone).
//
// No residual may under- or overflow: operands of ordinary size are far from both (`pc_easy`), of others the
// corrections work on mantissas in [1, 4), and exponents are put back as bits. What is no normal number, before or
// after, takes the built-in, which is exact there.
// The text is also compiled as C++ by tests/gl_rounding.cpp.
#ifdef PC_DOUBLE
#define PC_BIAS 1023u
#define PC_EXPONENT_END 2047u
PC_FN uint pc_exponent(Real x) { return (unpackDouble2x32(x).y >> 20u) & 2047u; }
PC_FN Real pc_with_exponent(Real x, uint e) {
  uvec2 b = unpackDouble2x32(x);
  return packDouble2x32(uvec2(b.x, (b.y & 0x800fffffu) | (e << 20u)));
}
PC_FN Real pc_above(Real x) {
  uvec2 b = unpackDouble2x32(x);
  return packDouble2x32(uvec2(b.x + 1u, b.x == 0xffffffffu ? b.y + 1u : b.y));
}
PC_FN Real pc_below(Real x) {
  uvec2 b = unpackDouble2x32(x);
  return packDouble2x32(uvec2(b.x - 1u, b.x == 0u ? b.y - 1u : b.y));
}
#else
#define PC_BIAS 127u
#define PC_EXPONENT_END 255u
PC_FN uint pc_exponent(Real x) { return (floatBitsToUint(x) >> 23u) & 255u; }
PC_FN Real pc_with_exponent(Real x, uint e) { return uintBitsToFloat((floatBitsToUint(x) & 0x807fffffu) | (e << 23u)); }
PC_FN Real pc_above(Real x) { return uintBitsToFloat(floatBitsToUint(x) + 1u); }
PC_FN Real pc_below(Real x) { return uintBitsToFloat(floatBitsToUint(x) - 1u); }
#endif
#ifdef PC_DOUBLE
#define PC_EASY Real(1e30)
#else
#define PC_EASY Real(1e15)
#endif
PC_FN bool pc_easy(Real least, Real most) { return least > Real(1.0) / PC_EASY && most < PC_EASY; }
PC_FN bool pc_ordinary(uint exponent) { return exponent != 0u && exponent != PC_EXPONENT_END; }

// ---- division ---------------------------------------------------------------------------------------
PC_FN Real pc_div_builtin(Real a, Real b) {
  precise Real q = pc_device_div(a, b);
  return q;
}

PC_FN Real pc_div_step(Real a, Real b) {
  precise Real r0 = pc_device_div(Real(1.0), b);
  precise Real e = pc_device_fma(-r0, b, Real(1.0));
  precise Real r = pc_device_fma(e, r0, r0);
  precise Real q = a * r;
  precise Real f = pc_device_fma(-q, b, a);
  precise Real o = pc_device_fma(f, r, q);
  return o;
}
// A quotient is never a tie, so the smallest residual decides.
PC_FN Real pc_div_choice(Real q, Real a, Real b) {
  Real u = pc_above(q);
  Real d = pc_below(q);
  precise Real fq = pc_device_fma(-q, b, a);
  precise Real fu = pc_device_fma(-u, b, a);
  precise Real fd = pc_device_fma(-d, b, a);
  Real best = abs(fu) < abs(fq) ? u : q;
  return abs(fd) < abs(fq) ? d : best;
}
// q of the mantissas becomes a / b; `plain` where that is no normal number.
PC_FN Real pc_div_result(Real q, Real a, Real b, Real plain) {
  int e = int(pc_exponent(q)) + int(pc_exponent(a)) - int(pc_exponent(b));
  bool ordinary = pc_ordinary(pc_exponent(a)) && pc_ordinary(pc_exponent(b)) && e > 0 && e < int(PC_EXPONENT_END);
  Real magnitude = pc_with_exponent(q, uint(e) & PC_EXPONENT_END);
  Real signed_result = (a < Real(0.0)) != (b < Real(0.0)) ? -magnitude : magnitude;
  return ordinary ? signed_result : plain;
}
PC_FN Real pc_div_fma(Real a, Real b) {
  Real q = pc_div_step(a, b);
  if (!pc_easy(min(abs(a), abs(b)), max(abs(a), abs(b)))) {
    Real x = pc_with_exponent(abs(a), PC_BIAS);
    Real y = pc_with_exponent(abs(b), PC_BIAS);
    q = pc_div_result(pc_div_step(x, y), a, b, pc_div_builtin(a, b));
  }
  return q;
}
PC_FN Real pc_div_nearest(Real a, Real b) {
  Real q = pc_div_choice(pc_div_step(a, b), a, b);
  if (!pc_easy(min(abs(a), abs(b)), max(abs(a), abs(b)))) {
    Real x = pc_with_exponent(abs(a), PC_BIAS);
    Real y = pc_with_exponent(abs(b), PC_BIAS);
    q = pc_div_result(pc_div_choice(pc_div_step(x, y), x, y), a, b, pc_div_builtin(a, b));
  }
  return q;
}

// ---- square root ------------------------------------------------------------------------------------
PC_FN Real pc_sqrt_builtin(Real x) {
  precise Real s = pc_device_sqrt(x);
  return s;
}

#ifdef PC_DOUBLE
PC_FN Real pc_sqrt_step(Real x) {
  precise Real s0 = pc_device_sqrt(x);
  precise Real half_inverse = pc_device_div(Real(0.5), s0);
#else
PC_FN Real pc_sqrt_step(Real x) {
  precise Real inverse = pc_device_inverse_sqrt(x);  // a GPU's own; its root and a division are made of it
  precise Real s0 = x * inverse;
  precise Real half_inverse = Real(0.5) * inverse;
#endif
  precise Real e = pc_device_fma(-s0, s0, x);
  precise Real s = pc_device_fma(e, half_inverse, s0);
  return s;
}
// s is right when s * pred(s) < x <= s * succ(s).
PC_FN Real pc_sqrt_choice(Real s, Real x) {
  Real u = pc_above(s);
  Real d = pc_below(s);
  precise Real fu = pc_device_fma(-s, u, x);
  precise Real fd = pc_device_fma(-s, d, x);
  Real best = fu > Real(0.0) ? u : s;
  return fd <= Real(0.0) ? d : best;
}
// An even power of two apart from x, in [1, 4).
PC_FN uint pc_sqrt_home(Real x) { return PC_BIAS + 1u - (pc_exponent(x) & 1u); }
PC_FN Real pc_sqrt_result(Real s, Real x) {
  int shift = (int(pc_exponent(x)) - int(pc_sqrt_home(x))) / 2;
  bool ordinary = pc_ordinary(pc_exponent(x)) && x > Real(0.0);
  return ordinary ? pc_with_exponent(s, uint(int(pc_exponent(s)) + shift) & PC_EXPONENT_END) : pc_sqrt_builtin(x);
}
PC_FN Real pc_sqrt_fma(Real x) {
  Real s = pc_sqrt_step(x);
  if (!pc_easy(x, x)) {
    Real m = pc_with_exponent(abs(x), pc_sqrt_home(x));
    s = pc_sqrt_result(pc_sqrt_step(m), x);
  }
  return s;
}
PC_FN Real pc_sqrt_nearest(Real x) {
  Real s = pc_sqrt_choice(pc_sqrt_step(x), x);
  if (!pc_easy(x, x)) {
    Real m = pc_with_exponent(abs(x), pc_sqrt_home(x));
    s = pc_sqrt_result(pc_sqrt_choice(pc_sqrt_step(m), m), x);
  }
  return s;
}
