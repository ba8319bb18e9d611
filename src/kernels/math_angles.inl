// Sines, cosines and angles, and rotations of which the angle is given; part of math.inl.

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

// An angle as quarter turns, a whole number of them, and a rest within [-pi/4, pi/4].
struct QuarterTurns {
  Real quarters;
  Real rest;
};
// Cody-Waite reduction by pi/2 in three parts, |x| up to 1e4.
// Beyond 3e4 the angle is cut off: the reduction has no digits left there, and the result must stay finite.
PC_FN QuarterTurns pc_quarter_turns(Real angle) {
  Real x = pc_clamp(angle, PC_REAL(-30000.0), PC_REAL(30000.0));
  precise Real turns = x * PC_REAL(0.63661977236758134308);
  Real k = pc_round(turns);
#ifdef PC_DOUBLE
  precise Real r0 = x - k * PC_REAL(1.57079632673412561417);
  precise Real r1 = r0 - k * PC_REAL(6.07710050630396597660e-11);
  precise Real r2 = r1 - k * PC_REAL(2.02226624879595063154e-21);
#else
  precise Real r0 = x - k * PC_REAL(1.5703125);
  precise Real r1 = r0 - k * PC_REAL(4.8375129699707031e-4);
  precise Real r2 = r1 - k * PC_REAL(7.5497899548918822e-8);
#endif
  QuarterTurns o;
  o.quarters = k;
  o.rest = r2;
  return o;
}

// fall: cosine - 1, with the digits that the difference would lose.
struct SinCos {
  Real sine;
  Real cosine;
  Real fall;
};
// Minimax polynomials on [-pi/4, pi/4] (the coefficients of the Cephes library, S. Moshier; single and double).
PC_FN SinCos pc_sincos_of_rest(Real r) {
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
  return o;
}
// Of an angle that is k quarter turns more.
PC_FN SinCos pc_sincos_turned(SinCos rest, Real k) {
  // quadrant: k mod 4 in {-2, -1, 0, 1, 2}
  precise Real quarter = k * PC_REAL(0.25);
  Real whole = pc_round(quarter);
  precise Real quadrant = k - whole * PC_REAL(4.0);
  precise Real off_odd = pc_abs(quadrant) - PC_REAL(1.0);
  Mask odd = pc_abs(off_odd) < PC_REAL(0.5);
  Mask opposite = pc_abs(quadrant) > PC_REAL(1.5);
  Real p = pc_select(odd, rest.cosine, rest.sine);
  Real q = pc_select(odd, rest.sine, rest.cosine);
  // quadrant 1: (c, -s); -1: (-c, s); 2: (-s, -c)
  Mask negate_sine = pc_or(opposite, quadrant < PC_REAL(-0.5));
  Mask negate_cosine = pc_or(opposite, quadrant > PC_REAL(0.5));
  Real cosine = pc_select(negate_cosine, -q, q);
  precise Real below = cosine - PC_REAL(1.0);
  Mask near = pc_abs(quadrant) < PC_REAL(0.5);
  SinCos o;
  o.sine = pc_select(negate_sine, -p, p);
  o.cosine = cosine;
  o.fall = pc_select(near, rest.fall, below);
  return o;
}
// Less than a quarter turn has nothing to be taken out of it: the same bits, less work.
PC_FN SinCos pc_sincos(Real angle) {
  Real quarters = PC_REAL(0.0);
  Real rest = angle;
  Mask far = pc_abs(angle) > PC_REAL(0.75);
  if (PC_ANY(far)) {  // lint: allow (the rest of an angle that is not far is itself)
    QuarterTurns turns = pc_quarter_turns(angle);
    quarters = turns.quarters;
    rest = turns.rest;
  }
  SinCos o = pc_sincos_of_rest(rest);
  if (!PC_ANY(far)) return o;  // lint: allow (quadrant 0)
  return pc_sincos_turned(o, quarters);
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
