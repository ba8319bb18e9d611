// Arithmetic shared by all kernels: common subset of C++20 and GLSL 4.30.
//
// The backend defines Real, Mask, Vec3, Index, Slot, PC_FN, PC_INOUT, PC_REAL, PC_ANY, pc_select, pc_and, pc_or,
// pc_abs, pc_div, pc_sqrt. Rules, which tools/check_kernels.py enforces: every arithmetic result stands in
// a `precise` local (an empty macro in C++), sums are written left to right, no built-in vector functions,
// no operator /, constants through PC_REAL. Only then do CPU and GPU agree to the bit.

// Four consecutive reals of a row.
struct Quad {
  Vec3 v;
  Real s;
};
struct Sym3 {
  Real xx;
  Real xy;
  Real xz;
  Real yy;
  Real yz;
  Real zz;
};
struct Quaternion {
  Vec3 v;
  Real w;
};

PC_FN Quad pc_quad(Vec3 v, Real s) {
  Quad q;
  q.v = v;
  q.s = s;
  return q;
}
PC_FN Quaternion pc_quaternion(Vec3 v, Real w) {
  Quaternion q;
  q.v = v;
  q.w = w;
  return q;
}
PC_FN Vec3 pc_zero3() { return Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0)); }

// ---- numbers ------------------------------------------------------------------------------------------
// Kernels hold 0, 0.5, 1 and 2 bare. Every other number has a name: here, or in the one file that needs it
// (tools/check_kernels.py).
#define PC_THIRD PC_REAL(0.333333333333333333)
#define PC_SIXTH PC_REAL(0.16666666666666666667)
#define PC_TWELFTH PC_REAL(0.083333333333333333)
#define PC_ROOT_HALF PC_REAL(0.70710678118654752)
// A unit vector has a component below it, so that an axis of the world that is far from it is found so.
#define PC_STEEP PC_REAL(0.57)
// The distance from 1 to the next number.
#ifdef PC_DOUBLE
#define PC_EPSILON PC_REAL(2.220446049250313e-16)
#else
#define PC_EPSILON PC_REAL(1.1920928955078125e-7)
#endif
// What is none beside one: a sine, a share, or the square of one; what is little of it; and what is some.
#define PC_SLIGHT PC_REAL(1e-6)
#define PC_LITTLE PC_REAL(1e-4)
#define PC_SOME PC_REAL(1e-2)
// A factor that outdoes what single precision rounds in a length or a time.
#define PC_SURELY PC_REAL(1.00001)
// No slack, depth or ratio of what exists goes so far.
#define PC_FAR PC_REAL(1e9)

PC_FN Real pc_four_times(Real x) {
  precise Real twice = x + x;
  precise Real r = twice + twice;
  return r;
}
PC_FN Real pc_quarter(Real x) {
  precise Real r = x * PC_REAL(0.5) * PC_REAL(0.5);
  return r;
}
PC_FN Real pc_max(Real a, Real b) { return pc_select(a < b, b, a); }
PC_FN Real pc_min(Real a, Real b) { return pc_select(b < a, b, a); }
PC_FN Real pc_clamp(Real x, Real low, Real high) { return pc_min(pc_max(x, low), high); }
PC_FN Vec3 pc_select3(Mask m, Vec3 a, Vec3 b) {
  return Vec3(pc_select(m, a.x, b.x), pc_select(m, a.y, b.y), pc_select(m, a.z, b.z));
}

PC_FN Real pc_dot(Vec3 a, Vec3 b) {
  precise Real r = a.x * b.x + a.y * b.y + a.z * b.z;
  return r;
}
PC_FN Vec3 pc_cross(Vec3 a, Vec3 b) {
  precise Real x = a.y * b.z - a.z * b.y;
  precise Real y = a.z * b.x - a.x * b.z;
  precise Real z = a.x * b.y - a.y * b.x;
  return Vec3(x, y, z);
}
PC_FN Vec3 pc_add(Vec3 a, Vec3 b) {
  precise Vec3 r = a + b;
  return r;
}
PC_FN Vec3 pc_sub(Vec3 a, Vec3 b) {
  precise Vec3 r = a - b;
  return r;
}
PC_FN Vec3 pc_scale(Vec3 a, Real s) {
  precise Vec3 r = a * s;
  return r;
}
PC_FN Vec3 pc_madd(Vec3 a, Vec3 b, Real s) {
  precise Vec3 r = a + b * s;
  return r;
}
PC_FN Vec3 pc_combine(Vec3 a, Real x, Vec3 b, Real y, Vec3 c, Real z) {
  precise Vec3 r = a * x + b * y + c * z;
  return r;
}
// The rounded sum of two vectors, and what rounding dropped from it (Knuth's two-sum).
struct TwoSum {
  Vec3 sum;
  Vec3 low;
};
PC_FN Real pc_two_sum_error(Real a, Real b, Real sum) {
  precise Real bb = sum - a;
  precise Real aa = sum - bb;
  precise Real eb = b - bb;
  precise Real ea = a - aa;
  precise Real e = ea + eb;
  return e;
}
PC_FN TwoSum pc_two_sum(Vec3 a, Vec3 b) {
  TwoSum r;
  r.sum = pc_add(a, b);
  r.low = Vec3(pc_two_sum_error(a.x, b.x, r.sum.x), pc_two_sum_error(a.y, b.y, r.sum.y),
               pc_two_sum_error(a.z, b.z, r.sum.z));
  return r;
}
PC_FN Vec3 pc_negate(Vec3 a) { return Vec3(-a.x, -a.y, -a.z); }
// The smallest number that no device flushes.
#ifdef PC_DOUBLE
#define PC_LEAST PC_REAL(2.2250738585072014e-308)
#else
#define PC_LEAST PC_REAL(1.1754943508222875e-38)
#endif
// (what some devices flush has no inverse anywhere)
PC_FN Real pc_inverse_or_zero(Real x) { return pc_select(x > PC_LEAST, pc_div(PC_REAL(1.0), x), PC_REAL(0.0)); }
PC_FN Real pc_length(Vec3 a) { return pc_sqrt(pc_dot(a, a)); }
// By how much to scale what is so large, that it is no larger than `most`.
PC_FN Real pc_share_within(Real size, Real most) {
  return pc_select(size > most, pc_div(most, pc_max(size, most)), PC_REAL(1.0));
}
PC_FN Vec3 pc_unit_or_zero(Vec3 a) { return pc_scale(a, pc_inverse_or_zero(pc_length(a))); }

// Below PC_TINY stored values snap to zero, so that products of two of them never become subnormal:
// some devices flush subnormals, others keep them.
#ifdef PC_DOUBLE
#define PC_TINY PC_REAL(1e-150)
#else
#define PC_TINY PC_REAL(1e-18)
#endif
// x^2 / (1 + x^2) for x >= 0, nothing where it would be subnormal: of what a sub-step does not resolve, the share that
// is to be implicit.
PC_FN Real pc_unresolved(Real x) {
  Real most = pc_select(x < PC_TINY, PC_REAL(0.0), pc_min(x, PC_FAR));
  precise Real square = most * most;
  precise Real all = square + PC_REAL(1.0);
  return pc_div(square, all);
}
// Anything but zero; what is no number, too.
PC_FN Mask pc_nonzero(Real x) { return pc_select(pc_abs(x) < PC_LEAST, PC_REAL(0.0), PC_REAL(1.0)) > PC_REAL(0.5); }
PC_FN Real pc_snap(Real x) { return pc_select(pc_abs(x) < PC_TINY, PC_REAL(0.0), x); }
PC_FN Vec3 pc_snap3(Vec3 a) { return Vec3(pc_snap(a.x), pc_snap(a.y), pc_snap(a.z)); }
// Of an impulse at an arm, and a couple beside it.
PC_FN Vec3 pc_moment(Vec3 couple, Vec3 arm, Vec3 impulse) { return pc_snap3(pc_add(couple, pc_cross(arm, impulse))); }

PC_FN Vec3 pc_sym_mul(Sym3 m, Vec3 v) {
  precise Real x = m.xx * v.x + m.xy * v.y + m.xz * v.z;
  precise Real y = m.xy * v.x + m.yy * v.y + m.yz * v.z;
  precise Real z = m.xz * v.x + m.yz * v.y + m.zz * v.z;
  return Vec3(x, y, z);
}
PC_FN Sym3 pc_sym_add(Sym3 a, Sym3 b) {
  precise Real xx = a.xx + b.xx;
  precise Real xy = a.xy + b.xy;
  precise Real xz = a.xz + b.xz;
  precise Real yy = a.yy + b.yy;
  precise Real yz = a.yz + b.yz;
  precise Real zz = a.zz + b.zz;
  Sym3 r;
  r.xx = xx;
  r.xy = xy;
  r.xz = xz;
  r.yy = yy;
  r.yz = yz;
  r.zz = zz;
  return r;
}
// Inverse by cofactors; zero where the determinant is not above zero (padding, two fixed bodies).
PC_FN Sym3 pc_sym_inverse(Sym3 m) {
  precise Real a = m.yy * m.zz - m.yz * m.yz;
  precise Real b = m.xz * m.yz - m.xy * m.zz;
  precise Real c = m.xy * m.yz - m.xz * m.yy;
  precise Real d = m.xx * m.zz - m.xz * m.xz;
  precise Real e = m.xy * m.xz - m.xx * m.yz;
  precise Real f = m.xx * m.yy - m.xy * m.xy;
  precise Real det = m.xx * a + m.xy * b + m.xz * c;
  Real i = pc_inverse_or_zero(det);
  precise Real xx = a * i;
  precise Real xy = b * i;
  precise Real xz = c * i;
  precise Real yy = d * i;
  precise Real yz = e * i;
  precise Real zz = f * i;
  Sym3 r;
  r.xx = xx;
  r.xy = xy;
  r.xz = xz;
  r.yy = yy;
  r.yz = yz;
  r.zz = zz;
  return r;
}

// ---- rotations ----------------------------------------------------------------------------------------
PC_FN Vec3 pc_rotate(Quaternion q, Vec3 v) {
  Vec3 c = pc_cross(q.v, v);
  precise Vec3 t = c * PC_REAL(2.0);
  Vec3 d = pc_cross(q.v, t);
  precise Vec3 r = v + t * q.w + d;
  return r;
}
// A vector rotated, less the vector: with the digits that a difference of the two would lose.
PC_FN Vec3 pc_swing(Quaternion q, Vec3 v) {
  Vec3 c = pc_cross(q.v, v);
  precise Vec3 t = c * PC_REAL(2.0);
  precise Vec3 r = t * q.w + pc_cross(q.v, t);
  return r;
}
// The same with one product less and half its error, by which nets keep their momentum.
PC_FN Vec3 pc_swing_closely(Quaternion q, Vec3 v) {
  Vec3 half_way = pc_cross(q.v, pc_madd(pc_cross(q.v, v), v, q.w));
  return pc_scale(half_way, PC_REAL(2.0));
}
PC_FN Quaternion pc_conjugate(Quaternion q) { return pc_quaternion(pc_negate(q.v), q.w); }
PC_FN Quaternion pc_quaternion_mul(Quaternion a, Quaternion b) {
  Vec3 c = pc_cross(a.v, b.v);
  precise Vec3 v = b.v * a.w + a.v * b.w + c;
  precise Real w = a.w * b.w - a.v.x * b.v.x - a.v.y * b.v.y - a.v.z * b.v.z;
  return pc_quaternion(v, w);
}

// World-axes inverse inertia of a body whose principal inverse moments are `m`, orientation q: R diag(m) R^T.
PC_FN Sym3 pc_world_inertia(Quaternion q, Vec3 m) {
  Vec3 a = pc_rotate(q, Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0)));
  Vec3 b = pc_rotate(q, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)));
  Vec3 c = pc_cross(a, b);
  precise Real xx = m.x * a.x * a.x + m.y * b.x * b.x + m.z * c.x * c.x;
  precise Real xy = m.x * a.x * a.y + m.y * b.x * b.y + m.z * c.x * c.y;
  precise Real xz = m.x * a.x * a.z + m.y * b.x * b.z + m.z * c.x * c.z;
  precise Real yy = m.x * a.y * a.y + m.y * b.y * b.y + m.z * c.y * c.y;
  precise Real yz = m.x * a.y * a.z + m.y * b.y * b.z + m.z * c.y * c.z;
  precise Real zz = m.x * a.z * a.z + m.y * b.z * b.z + m.z * c.z * c.z;
  Sym3 r;
  r.xx = xx;
  r.xy = xy;
  r.xz = xz;
  r.yy = yy;
  r.yz = yz;
  r.zz = zz;
  return r;
}

// ---- elementary functions -----------------------------------------------------------------------------
// Nearest integer by adding and removing 1.5 * 2^(mantissa bits): exact on both sides, |x| < 2^22 (2^51).
#ifdef PC_DOUBLE
#define PC_ROUNDER PC_REAL(6755399441055744.0)
#else
#define PC_ROUNDER PC_REAL(12582912.0)
#endif
PC_FN Real pc_round(Real x) {
  precise Real a = x + PC_ROUNDER;
  precise Real b = a - PC_ROUNDER;
  return b;
}

// fall: cosine - 1, with the digits that the difference would lose.
struct SinCos {
  Real sine;
  Real cosine;
  Real fall;
};
// Cody-Waite reduction by pi/2 in three parts, then minimax polynomials on [-pi/4, pi/4] (the coefficients
// of the Cephes library, S. Moshier; single and double). |x| up to 1e4.
// Beyond 3e4 the angle is cut off: the reduction has no digits left there, and the result must stay finite.
// Less than a quarter turn has nothing to be taken out of it: the same bits, less work.
PC_FN SinCos pc_sincos(Real angle) {
  Real r = angle;
  Real k = PC_REAL(0.0);
  Mask far = pc_abs(angle) > PC_REAL(0.75);
  if (PC_ANY(far)) {  // lint: allow (the rest of an angle that is not far is itself)
    Real x = pc_clamp(angle, PC_REAL(-30000.0), PC_REAL(30000.0));
    precise Real turns = x * PC_REAL(0.63661977236758134308);
    k = pc_round(turns);
#ifdef PC_DOUBLE
    precise Real r0 = x - k * PC_REAL(1.57079632673412561417);
    precise Real r1 = r0 - k * PC_REAL(6.07710050630396597660e-11);
    precise Real r2 = r1 - k * PC_REAL(2.02226624879595063154e-21);
    r = r2;
#else
    precise Real r0 = x - k * PC_REAL(1.5703125);
    precise Real r1 = r0 - k * PC_REAL(4.8375129699707031e-4);
    precise Real r2 = r1 - k * PC_REAL(7.5497899548918822e-8);
    r = r2;
#endif
  }
  precise Real z = r * r;
#ifdef PC_DOUBLE
  precise Real s0 = ((((PC_REAL(1.58962301576546568060e-10) * z - PC_REAL(2.50507477628578072866e-8)) * z +
                       PC_REAL(2.75573136213857245213e-6)) *
                          z -
                      PC_REAL(1.98412698295895385996e-4)) *
                         z +
                     PC_REAL(8.33333333332211858878e-3)) *
                        z -
                    PC_REAL(1.66666666666666307295e-1);
  precise Real c0 = ((((PC_REAL(2.08757008419747316778e-9) - PC_REAL(1.13585365213876817300e-11) * z) * z -
                       PC_REAL(2.75573141792967388112e-7)) *
                          z +
                      PC_REAL(2.48015872888517045348e-5)) *
                         z -
                     PC_REAL(1.38888888888730564116e-3)) *
                        z +
                    PC_REAL(4.16666666666665929218e-2);
#else
  precise Real s0 = (PC_REAL(8.3321608736e-3) - PC_REAL(1.9515295891e-4) * z) * z - PC_REAL(1.6666654611e-1);
  precise Real c0 =
      (PC_REAL(2.443315711809948e-5) * z - PC_REAL(1.388731625493765e-3)) * z + PC_REAL(4.166664568298827e-2);
#endif
  precise Real s = r + r * z * s0;
  precise Real fallen = z * z * c0 - PC_REAL(0.5) * z;
  precise Real c = PC_REAL(1.0) + fallen;
  SinCos o;
  o.sine = s;
  o.cosine = c;
  o.fall = fallen;
  if (!PC_ANY(far)) return o;  // lint: allow (quadrant 0)
  // quadrant: k mod 4 in {-2, -1, 0, 1, 2}
  precise Real quarter = k * PC_REAL(0.25);
  Real whole = pc_round(quarter);
  precise Real quadrant = k - whole * PC_REAL(4.0);
  precise Real off_odd = pc_abs(quadrant) - PC_REAL(1.0);
  Mask odd = pc_abs(off_odd) < PC_REAL(0.5);
  Mask opposite = pc_abs(quadrant) > PC_REAL(1.5);
  Real p = pc_select(odd, c, s);
  Real q = pc_select(odd, s, c);
  // quadrant 1: (c, -s); -1: (-c, s); 2: (-s, -c)
  Mask negate_sine = pc_or(opposite, quadrant < PC_REAL(-0.5));
  Mask negate_cosine = pc_or(opposite, quadrant > PC_REAL(0.5));
  Real cosine = pc_select(negate_cosine, -q, q);
  precise Real below = cosine - PC_REAL(1.0);
  Mask near = pc_abs(quadrant) < PC_REAL(0.5);
  o.sine = pc_select(negate_sine, -p, p);
  o.cosine = cosine;
  o.fall = pc_select(near, fallen, below);
  return o;
}

// A rotation, and w - 1 beside its w: what it changes is then known to the last digit however small it is.
struct Turn {
  Quaternion q;
  Real fall;
};
// By `angle` about the unit vector `axis`.
PC_FN Turn pc_axis_turn(Vec3 axis, Real angle) {
  precise Real half_angle = angle * PC_REAL(0.5);
  SinCos t = pc_sincos(half_angle);
  Turn r;
  r.q = pc_quaternion(pc_scale(axis, t.sine), t.cosine);
  r.fall = t.fall;
  return r;
}
// exp of a rotation vector. One whose square would be subnormal is none: some devices flush that square, others
// keep it, and the axis would differ.
PC_FN Turn pc_turn(Vec3 vector) {
  Vec3 phi = pc_snap3(vector);
  Real angle = pc_length(phi);
  if (!PC_ANY(pc_nonzero(angle))) {  // lint: allow (what the rest makes of none)
    Turn r;
    r.q = pc_quaternion(pc_zero3(), PC_REAL(1.0));
    r.fall = PC_REAL(0.0);
    return r;
  }
  return pc_axis_turn(pc_scale(phi, pc_inverse_or_zero(angle)), angle);
}
// What two turns change together: (1 + a) (1 + b) - 1 = a + b + a b.
PC_FN Turn pc_turn_mul(Turn a, Turn b) {
  Quaternion x = pc_quaternion(a.q.v, a.fall);
  Quaternion y = pc_quaternion(b.q.v, b.fall);
  Quaternion xy = pc_quaternion_mul(x, y);
  precise Real fall = x.w + y.w + xy.w;
  precise Vec3 v = x.v + y.v + xy.v;
  precise Real w = PC_REAL(1.0) + fall;
  Turn r;
  r.q = pc_quaternion(v, w);
  r.fall = fall;
  return r;
}

// Angle of the point (x, y) with y >= 0, in [0, pi]: t = min / max, halved once about tan(pi/8), then the
// odd polynomial (single: Cephes atanf; double: Cephes atan's rational form).
PC_FN Real pc_angle(Real y, Real x) {
  Real ax = pc_abs(x);
  Mask steep = y > ax;
  Real low = pc_select(steep, ax, y);
  Real high = pc_max(pc_select(steep, y, ax), PC_TINY);
  precise Real eighth = PC_REAL(0.41421356237309503) * high;
  Mask upper = low > eighth;
  // atan(t) = pi/4 + atan((t - 1) / (t + 1))
  precise Real difference = low - high;
  precise Real sum = low + high;
  Real t = pc_div(pc_select(upper, difference, low), pc_select(upper, sum, high));
  precise Real z = t * t;
#ifdef PC_DOUBLE
  precise Real p = (((PC_REAL(-8.750608600031904122785e-1) * z - PC_REAL(1.615753718733365076637e1)) * z -
                     PC_REAL(7.500855792314704667340e1)) *
                        z -
                    PC_REAL(1.228866684490136173410e2)) *
                       z -
                   PC_REAL(6.485021904942025371773e1);
  precise Real q = ((((z + PC_REAL(2.485846490142306297962e1)) * z + PC_REAL(1.650270098316988542046e2)) * z +
                     PC_REAL(4.328810604912902668951e2)) *
                        z +
                    PC_REAL(4.853903996359136964868e2)) *
                       z +
                   PC_REAL(1.945506571482613964425e2);
  precise Real poly = t + t * (z * pc_div(p, q));
#else
  precise Real poly =
      (((PC_REAL(8.05374449538e-2) * z - PC_REAL(1.38776856032e-1)) * z + PC_REAL(1.99777106478e-1)) * z -
       PC_REAL(3.33329491539e-1)) *
          z * t +
      t;
#endif
  precise Real a0 = poly + pc_select(upper, PC_REAL(0.78539816339744830962), PC_REAL(0.0));
  precise Real a1 = PC_REAL(1.57079632679489661923) - a0;
  Real a = pc_select(steep, a1, a0);
  precise Real supplement = PC_REAL(3.14159265358979323846) - a;
  return pc_select(x < PC_REAL(0.0), supplement, a);
}

// e = exp(-x), phi = (1 - e) / x and phi2 = (1 - phi) / x for x >= 0 (clamped to 60): with them linear drag
// is exact under constant force. Taylor series of phi2 at y = x / 64, then six doublings:
//   phi(2y) = phi (1 - y phi / 2),  phi2(2y) = (phi2 + phi^2 / 2) / 2,  e(2y) = e(y)^2.
// Below x = 1, e = 1 - x phi rounds once instead of doubling its error six times. loss = 1 - e without
// cancellation: a velocity that is changed by its loss keeps the digits that multiplying by e would drop.
struct Decay {
  Real e;
  Real loss;
  Real phi;
  Real phi2;
};
PC_FN Decay pc_decay(Real drag_times_h) {
  if (!PC_ANY(pc_nonzero(drag_times_h))) {  // lint: allow (what the rest makes of none)
    Decay none;
    none.e = PC_REAL(1.0);
    none.loss = PC_REAL(0.0);
    none.phi = PC_REAL(1.0);
    none.phi2 = PC_REAL(0.5);
    return none;
  }
  Real x = pc_min(drag_times_h, PC_REAL(60.0));
  precise Real y0 = x * PC_REAL(0.015625);
  precise Real p2 = (((((((((((PC_REAL(7.6471637318198164759e-13) * y0 - PC_REAL(1.1470745597729724714e-11)) * y0 +
                              PC_REAL(1.6059043836821614599e-10)) *
                                 y0 -
                             PC_REAL(2.0876756987868098979e-9)) *
                                y0 +
                            PC_REAL(2.5052108385441718775e-8)) *
                               y0 -
                           PC_REAL(2.7557319223985890653e-7)) *
                              y0 +
                          PC_REAL(2.7557319223985890653e-6)) *
                             y0 -
                         PC_REAL(2.4801587301587301587e-5)) *
                            y0 +
                        PC_REAL(1.9841269841269841270e-4)) *
                           y0 -
                       PC_REAL(1.3888888888888888889e-3)) *
                          y0 +
                      PC_REAL(8.3333333333333333333e-3)) *
                         y0 -
                     PC_REAL(4.1666666666666666667e-2)) *
                        y0 +
                    PC_REAL(1.6666666666666666667e-1);
  precise Real q2 = PC_REAL(0.5) - y0 * p2;
  precise Real q1 = PC_REAL(1.0) - y0 * q2;
  precise Real q0 = PC_REAL(1.0) - y0 * q1;
  Real y = y0;
  Real e = q0;
  Real phi = q1;
  Real phi2 = q2;
  for (uint k = 0u; k < 6u; k++) {
    precise Real n2 = (phi2 + phi * phi * PC_REAL(0.5)) * PC_REAL(0.5);
    precise Real n1 = phi * (PC_REAL(1.0) - y * phi * PC_REAL(0.5));
    precise Real n0 = e * e;
    precise Real twice = y + y;
    phi2 = n2;
    phi = n1;
    e = n0;
    y = twice;
  }
  precise Real loss = x * phi;
  precise Real gentle = PC_REAL(1.0) - loss;
  Decay d;
  d.e = pc_select(x < PC_REAL(1.0), gentle, e);
  d.loss = loss;
  d.phi = phi;
  d.phi2 = phi2;
  // beyond 60, e is no more than it is there; phi and phi2 go on falling
  Mask beyond = drag_times_h > x;
  if (PC_ANY(beyond)) {  // lint: allow (other lanes keep what they have)
    Real far = pc_max(drag_times_h, x);
    Real far_phi = pc_div(loss, far);
    precise Real rest = PC_REAL(1.0) - far_phi;
    d.phi = pc_select(beyond, far_phi, phi);
    d.phi2 = pc_select(beyond, pc_div(rest, far), phi2);
  }
  return d;
}
