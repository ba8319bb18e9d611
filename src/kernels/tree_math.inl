// Small matrices of the tree solve: 3 x 3, and 6-vectors of a linear and an angular part.

// Its rows.
struct Mat3 {
  Vec3 a;
  Vec3 b;
  Vec3 c;
};
// Linear and angular.
struct Six {
  Vec3 l;
  Vec3 a;
};
// [l c; c^T a]
struct Sym6 {
  Sym3 l;
  Mat3 c;
  Sym3 a;
};

PC_FN Mat3 pc_mat3(Vec3 a, Vec3 b, Vec3 c) {
  Mat3 m;
  m.a = a;
  m.b = b;
  m.c = c;
  return m;
}
PC_FN Six pc_six(Vec3 l, Vec3 a) {
  Six x;
  x.l = l;
  x.a = a;
  return x;
}
PC_FN Sym6 pc_sym6(Sym3 l, Mat3 c, Sym3 a) {
  Sym6 h;
  h.l = l;
  h.c = c;
  h.a = a;
  return h;
}
PC_FN Sym3 pc_diagonal(Real d) {
  Real o = PC_REAL(0.0);
  return pc_sym3(d, o, o, d, o, d);
}
PC_FN Vec3 pc_row0(Sym3 m) { return Vec3(m.xx, m.xy, m.xz); }
PC_FN Vec3 pc_row1(Sym3 m) { return Vec3(m.xy, m.yy, m.yz); }
PC_FN Vec3 pc_row2(Sym3 m) { return Vec3(m.xz, m.yz, m.zz); }
PC_FN Mat3 pc_transpose(Mat3 m) {
  return pc_mat3(Vec3(m.a.x, m.b.x, m.c.x), Vec3(m.a.y, m.b.y, m.c.y), Vec3(m.a.z, m.b.z, m.c.z));
}
PC_FN Vec3 pc_mat_mul(Mat3 m, Vec3 v) { return Vec3(pc_dot(m.a, v), pc_dot(m.b, v), pc_dot(m.c, v)); }
PC_FN Vec3 pc_mat_tmul(Mat3 m, Vec3 v) { return pc_combine(m.a, v.x, m.b, v.y, m.c, v.z); }
PC_FN Six pc_sym6_mul(Sym6 h, Six x) {
  return pc_six(pc_add(pc_sym_mul(h.l, x.l), pc_mat_mul(h.c, x.a)),
                pc_add(pc_mat_tmul(h.c, x.l), pc_sym_mul(h.a, x.a)));
}
// A lower triangle E (in the places of a symmetric matrix) times v, and E^T times v; of six, [l 0; c a].
PC_FN Vec3 pc_lower_mul(Sym3 e, Vec3 v) {
  precise Real x = e.xx * v.x;
  precise Real y = e.xy * v.x + e.yy * v.y;
  precise Real z = e.xz * v.x + e.yz * v.y + e.zz * v.z;
  return Vec3(x, y, z);
}
PC_FN Vec3 pc_lower_tmul(Sym3 e, Vec3 v) {
  precise Real x = e.xx * v.x + e.xy * v.y + e.xz * v.z;
  precise Real y = e.yy * v.y + e.yz * v.z;
  precise Real z = e.zz * v.z;
  return Vec3(x, y, z);
}
PC_FN Six pc_lower6_mul(Sym6 e, Six x) {
  return pc_six(pc_lower_mul(e.l, x.l), pc_add(pc_mat_mul(e.c, x.l), pc_lower_mul(e.a, x.a)));
}
PC_FN Six pc_lower6_tmul(Sym6 e, Six x) {
  return pc_six(pc_add(pc_lower_tmul(e.l, x.l), pc_mat_tmul(e.c, x.a)), pc_lower_tmul(e.a, x.a));
}
PC_FN Real pc_largest(Vec3 v) { return pc_max(pc_abs(v.x), pc_max(pc_abs(v.y), pc_abs(v.z))); }
PC_FN Sym3 pc_sym_sub(Sym3 a, Sym3 b) {
  precise Real xx = a.xx - b.xx;
  precise Real xy = a.xy - b.xy;
  precise Real xz = a.xz - b.xz;
  precise Real yy = a.yy - b.yy;
  precise Real yz = a.yz - b.yz;
  precise Real zz = a.zz - b.zz;
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
PC_FN Sym3 pc_sym_select(Mask m, Sym3 a, Sym3 b) {
  return pc_sym3(pc_select(m, a.xx, b.xx), pc_select(m, a.xy, b.xy), pc_select(m, a.xz, b.xz), pc_select(m, a.yy, b.yy),
                 pc_select(m, a.yz, b.yz), pc_select(m, a.zz, b.zz));
}
PC_FN Sym6 pc_sym6_add(Sym6 x, Sym6 y) {
  return pc_sym6(pc_sym_add(x.l, y.l), pc_mat3(pc_add(x.c.a, y.c.a), pc_add(x.c.b, y.c.b), pc_add(x.c.c, y.c.c)),
                 pc_sym_add(x.a, y.a));
}
// The symmetric matrix of dot products of the vectors u with the vectors v, where these commute.
PC_FN Sym3 pc_products(Vec3 u0, Vec3 u1, Vec3 u2, Vec3 v0, Vec3 v1, Vec3 v2) {
  return pc_sym3(pc_dot(u0, v0), pc_dot(u0, v1), pc_dot(u0, v2), pc_dot(u1, v1), pc_dot(u1, v2), pc_dot(u2, v2));
}
// a + sum of s_i x_i x_i^T
PC_FN Sym3 pc_sym_outer(Sym3 a, Vec3 x, Real s) {
  Vec3 y = pc_scale(x, s);
  precise Real xx = a.xx + x.x * y.x;
  precise Real xy = a.xy + x.x * y.y;
  precise Real xz = a.xz + x.x * y.z;
  precise Real yy = a.yy + x.y * y.y;
  precise Real yz = a.yz + x.y * y.z;
  precise Real zz = a.zz + x.z * y.z;
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
// Inverse by blocks: with W = l^-1 c and S = a - c^T W.
PC_FN Sym6 pc_sym6_inverse(Sym6 h) {
  Sym3 li = pc_sym_inverse(h.l);
  Mat3 ct = pc_transpose(h.c);
  // columns of W
  Vec3 w0 = pc_sym_mul(li, ct.a);
  Vec3 w1 = pc_sym_mul(li, ct.b);
  Vec3 w2 = pc_sym_mul(li, ct.c);
  Sym3 si = pc_sym_inverse(pc_sym_sub(h.a, pc_products(ct.a, ct.b, ct.c, w0, w1, w2)));
  Mat3 w = pc_transpose(pc_mat3(w0, w1, w2));
  // rows of W S^-1
  Vec3 c0 = pc_sym_mul(si, w.a);
  Vec3 c1 = pc_sym_mul(si, w.b);
  Vec3 c2 = pc_sym_mul(si, w.c);
  return pc_sym6(pc_sym_add(li, pc_products(c0, c1, c2, w.a, w.b, w.c)),
                 pc_mat3(pc_negate(c0), pc_negate(c1), pc_negate(c2)), si);
}
// X^T h X, where X x = (l + a x d, a) moves a motion along the arm d.
PC_FN Sym6 pc_sym6_shift(Sym6 h, Vec3 d) {
  Sym6 r;
  r.l = h.l;
  r.c = pc_mat3(pc_sub(h.c.a, pc_cross(pc_row0(h.l), d)), pc_sub(h.c.b, pc_cross(pc_row1(h.l), d)),
                pc_sub(h.c.c, pc_cross(pc_row2(h.l), d)));
  Mat3 ct = pc_transpose(h.c);
  Vec3 e0 = pc_sub(pc_row0(h.a), pc_cross(ct.a, d));
  Vec3 e1 = pc_sub(pc_row1(h.a), pc_cross(ct.b, d));
  Vec3 e2 = pc_sub(pc_row2(h.a), pc_cross(ct.c, d));
  precise Real xx = e0.x + d.y * r.c.c.x - d.z * r.c.b.x;
  precise Real xy = e0.y + d.y * r.c.c.y - d.z * r.c.b.y;
  precise Real xz = e0.z + d.y * r.c.c.z - d.z * r.c.b.z;
  precise Real yy = e1.y + d.z * r.c.a.y - d.x * r.c.c.y;
  precise Real yz = e1.z + d.z * r.c.a.z - d.x * r.c.c.z;
  precise Real zz = e2.z + d.x * r.c.b.z - d.y * r.c.a.z;
  r.a = pc_sym3(xx, xy, xz, yy, yz, zz);
  return r;
}
// Positive matrices m by the factor of their inverse: m^-1 = E^T d E, E a lower triangle with ones on its diagonal,
// where d stands in these. It stays positive, and a small scale beside large ones keeps its digits: cofactors are off
// by a rounding of the largest entry squared. A pivot is known no better than to a rounding of its diagonal.
PC_FN Sym3 pc_inverse_factor(Sym3 m) {
  Real dx = pc_inverse_or_zero(m.xx);
  precise Real yx = m.xy * dx;
  precise Real zx = m.xz * dx;
  precise Real yy = m.yy - m.xy * yx;
  precise Real zy_rest = m.yz - m.xz * yx;
  precise Real least_y = m.yy * PC_EPSILON;
  Real dy = pc_inverse_or_zero(pc_max(yy, least_y));
  precise Real zy = zy_rest * dy;
  precise Real zz = m.zz - m.xz * zx - zy_rest * zy;
  precise Real least_z = m.zz * PC_EPSILON;
  precise Real corner = yx * zy - zx;
  return pc_sym3(dx, -yx, corner, dy, -zy, pc_inverse_or_zero(pc_max(zz, least_z)));
}
PC_FN Vec3 pc_factor_lower(Sym3 f, Vec3 v) {
  precise Real y = v.y + f.xy * v.x;
  precise Real z = v.z + f.xz * v.x + f.yz * v.y;
  return Vec3(v.x, y, z);
}
PC_FN Vec3 pc_factor_upper(Sym3 f, Vec3 v) {
  precise Real x = v.x + f.xy * v.y + f.xz * v.z;
  precise Real y = v.y + f.yz * v.z;
  return Vec3(x, y, v.z);
}
PC_FN Vec3 pc_factor_scaled(Sym3 f, Vec3 v) {
  precise Real x = f.xx * v.x;
  precise Real y = f.yy * v.y;
  precise Real z = f.zz * v.z;
  return Vec3(x, y, z);
}
// m^-1 v, and m^-1 itself.
PC_FN Vec3 pc_factor_mul(Sym3 f, Vec3 v) { return pc_factor_upper(f, pc_factor_scaled(f, pc_factor_lower(f, v))); }
PC_FN Sym3 pc_of_factor(Sym3 f) {
  precise Real zzx = f.zz * f.xz;
  precise Real zzy = f.zz * f.yz;
  precise Real yyx = f.yy * f.xy;
  precise Real xx = f.xx + yyx * f.xy + zzx * f.xz;
  precise Real xy = yyx + zzx * f.yz;
  precise Real yy = f.yy + zzy * f.yz;
  return pc_sym3(xx, xy, zzx, yy, zzy, f.zz);
}
// Of m + s v v^T, from that of m (P. E. Gill, G. H. Golub, W. Murray and M. A. Saunders, Methods for Modifying Matrix
// Factorizations, 1974, method C1).
PC_FN Sym3 pc_factor_stiffened(Sym3 f, Vec3 v, Real s) {
  Real one = PC_REAL(1.0);
  Vec3 p = pc_factor_lower(f, v);
  precise Real px = p.x * f.xx;
  precise Real tx = one + s * p.x * px;
  Real gx = pc_div(one, tx);
  precise Real bx = px * s * gx;
  precise Real sy = s * gx;
  precise Real py = p.y * f.yy;
  precise Real ty = one + sy * p.y * py;
  Real gy = pc_div(one, ty);
  precise Real by = py * sy * gy;
  precise Real sz = sy * gy;
  precise Real pz = p.z * f.zz;
  precise Real tz = one + sz * p.z * pz;
  Real gz = pc_div(one, tz);
  precise Real dx = f.xx * gx;
  precise Real dy = f.yy * gy;
  precise Real dz = f.zz * gz;
  precise Real yx = f.xy - p.y * bx;
  precise Real zy = f.yz - p.z * by;
  precise Real zx = f.xz - p.z * by * f.xy - p.z * bx * gy;
  return pc_sym3(dx, yx, zx, dy, zy, dz);
}
// F, a lower triangle with F^T F = m^-1 scale^2.
PC_FN Sym3 pc_root_of_factor(Sym3 f, Real scale) {
  precise Real x = pc_sqrt(f.xx) * scale;
  precise Real y = pc_sqrt(f.yy) * scale;
  precise Real z = pc_sqrt(f.zz) * scale;
  precise Real yx = f.xy * y;
  precise Real zx = f.xz * z;
  precise Real zy = f.yz * z;
  return pc_sym3(x, yx, zx, y, zy, z);
}
