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
// Kernels hold 0, 0.5, 1 and 2 bare. Every other number has a name:
// here, or in the one file that needs it (tools/check_kernels.py).
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
PC_FN Sym3 pc_sym3(Real xx, Real xy, Real xz, Real yy, Real yz, Real zz) {
  Sym3 m;
  m.xx = xx;
  m.xy = xy;
  m.xz = xz;
  m.yy = yy;
  m.yz = yz;
  m.zz = zz;
  return m;
}
PC_FN Sym3 pc_sym_scale(Sym3 m, Real s) {
  precise Real xx = m.xx * s;
  precise Real xy = m.xy * s;
  precise Real xz = m.xz * s;
  precise Real yy = m.yy * s;
  precise Real yz = m.yz * s;
  precise Real zz = m.zz * s;
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
PC_FN Sym3 pc_sym_add(Sym3 a, Sym3 b) {
  precise Real xx = a.xx + b.xx;
  precise Real xy = a.xy + b.xy;
  precise Real xz = a.xz + b.xz;
  precise Real yy = a.yy + b.yy;
  precise Real yz = a.yz + b.yz;
  precise Real zz = a.zz + b.zz;
  return pc_sym3(xx, xy, xz, yy, yz, zz);
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
  return pc_sym3(xx, xy, xz, yy, yz, zz);
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
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}

// ---- elementary functions -----------------------------------------------------------------------------
#include "math_angles.inl"
#include "math_decay.inl"
