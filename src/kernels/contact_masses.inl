// What the rows of a manifold need to know of the two bodies: how the relative twist at its centre answers, in the
// contact frame. Of free bodies (contact_prepare) or of bodies among joints (tree_contact_prepare).
PC_FN void pc_st3_rows(PC_IO Slot m, uint f, Vec3 v) {
  PC_ST(contact_rows, m, f, v.x);
  PC_ST(contact_rows, m, f + 1u, v.y);
  PC_ST(contact_rows, m, f + 2u, v.z);
}
#ifdef PC_SOME_ROWS
#define pc_st_mass(f, x) PC_ST(contact_rows, m, f, pc_select(r.these, x, PC_LD(contact_rows, m, f)))
#else
#define pc_st_mass(f, x) PC_ST(contact_rows, m, f, x)
#endif
struct Responses {
#ifdef PC_SOME_ROWS
  Mask these;  // others keep theirs
#endif
  Sym3 l;  // of (v1, v2, vn) to impulses along t1, t2, n
  Vec3 w1;
  Vec3 w2;
  Vec3 wn;  // of the turning about t1, t2 and n to the same impulses; and of (v1, v2, vn) to couples
  Sym3 a;   // of the turning to couples
};

// The smaller of the responses along the normal and along the tangents, of which it is the harmonic mean, whichever way
// they point. Zero says that the contact is left alone.
PC_FN Real pc_least_response(Sym3 l) {
  precise Real det = l.xx * l.yy - l.xy * l.xy;
  precise Real trace = l.xx + l.yy;
  precise Real tangents = PC_REAL(2.0) * det * pc_inverse_or_zero(trace);
  return pc_min(l.zz, pc_max(tangents, PC_REAL(0.0)));
}
// Effective masses and the responses between rows; `w0` to `w3`: 1 where the point exists.
PC_FN void pc_store_masses(PC_IO Slot m, Responses r, Real w0, Real w1, Real w2, Real w3) {
#ifndef PC_FRICTIONLESS
  // friction block and twist
  precise Real det = r.l.xx * r.l.yy - r.l.xy * r.l.xy;
  Real inverse_det = pc_inverse_or_zero(det);
  precise Real t11 = r.l.yy * inverse_det;
  precise Real t12 = -(r.l.xy * inverse_det);
  precise Real t22 = r.l.xx * inverse_det;
  pc_st_mass(ROW_TT, t11);
  pc_st_mass(ROW_TT + 1u, t12);
  pc_st_mass(ROW_TT + 2u, t22);
  pc_st_mass(ROW_KW, r.wn.x);
  pc_st_mass(ROW_KW + 1u, r.wn.y);
  pc_st_mass(ROW_TWIST, pc_inverse_or_zero(r.a.zz));
  pc_st_mass(ROW_C, r.l.xz);
  pc_st_mass(ROW_C + 1u, r.l.yz);
  pc_st_mass(ROW_C + 2u, r.wn.z);
  pc_st_mass(ROW_C + 3u, r.w1.x);
  pc_st_mass(ROW_C + 4u, r.w1.y);
  pc_st_mass(ROW_C + 5u, r.a.xz);
  pc_st_mass(ROW_C + 6u, r.w2.x);
  pc_st_mass(ROW_C + 7u, r.w2.y);
  pc_st_mass(ROW_C + 8u, r.a.yz);
#endif
  pc_st_mass(ROW_K, pc_least_response(r.l));

  // normal rows: u_i = K [1, b_i, -a_i] and their products
  Real a0 = PC_LD(contact_rows, m, ROW_A);
  Real a1 = PC_LD(contact_rows, m, ROW_A + 1u);
  Real a2 = PC_LD(contact_rows, m, ROW_A + 2u);
  Real a3 = PC_LD(contact_rows, m, ROW_A + 3u);
  Real b0 = PC_LD(contact_rows, m, ROW_B);
  Real b1 = PC_LD(contact_rows, m, ROW_B + 1u);
  Real b2 = PC_LD(contact_rows, m, ROW_B + 2u);
  Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
  Real nn = r.l.zz;
  Real n1 = r.w1.z;
  Real n2 = r.w2.z;
  Real m11 = r.a.xx;
  Real m12 = r.a.xy;
  Real m22 = r.a.yy;
  precise Real u0 = nn + n1 * b0 - n2 * a0;
  precise Real v0 = n1 + m11 * b0 - m12 * a0;
  precise Real x0 = n2 + m12 * b0 - m22 * a0;
  precise Real u1 = nn + n1 * b1 - n2 * a1;
  precise Real v1 = n1 + m11 * b1 - m12 * a1;
  precise Real x1 = n2 + m12 * b1 - m22 * a1;
  precise Real u2 = nn + n1 * b2 - n2 * a2;
  precise Real v2 = n1 + m11 * b2 - m12 * a2;
  precise Real x2 = n2 + m12 * b2 - m22 * a2;
  precise Real u3 = nn + n1 * b3 - n2 * a3;
  precise Real v3 = n1 + m11 * b3 - m12 * a3;
  precise Real x3 = n2 + m12 * b3 - m22 * a3;
  precise Real e0 = u0 + b0 * v0 - a0 * x0;
  precise Real q0 = pc_inverse_or_zero(e0) * w0;
  precise Real e1 = u1 + b1 * v1 - a1 * x1;
  precise Real q1 = pc_inverse_or_zero(e1) * w1;
  precise Real e2 = u2 + b2 * v2 - a2 * x2;
  precise Real q2 = pc_inverse_or_zero(e2) * w2;
  precise Real e3 = u3 + b3 * v3 - a3 * x3;
  precise Real q3 = pc_inverse_or_zero(e3) * w3;
  pc_st_mass(ROW_MASS, q0);
  pc_st_mass(ROW_MASS + 1u, q1);
  pc_st_mass(ROW_MASS + 2u, q2);
  pc_st_mass(ROW_MASS + 3u, q3);
  precise Real d01 = u0 + b1 * v0 - a1 * x0;
  precise Real d02 = u0 + b2 * v0 - a2 * x0;
  precise Real d03 = u0 + b3 * v0 - a3 * x0;
  precise Real d12 = u1 + b2 * v1 - a2 * x1;
  precise Real d13 = u1 + b3 * v1 - a3 * x1;
  precise Real d23 = u2 + b3 * v2 - a3 * x2;
  pc_st_mass(ROW_D, d01);
  pc_st_mass(ROW_D + 1u, d02);
  pc_st_mass(ROW_D + 2u, d03);
  pc_st_mass(ROW_D + 3u, d12);
  pc_st_mass(ROW_D + 4u, d13);
  pc_st_mass(ROW_D + 5u, d23);
}
#undef pc_st_mass
#ifdef PC_SOME_ROWS
// Of the points that there are, anew.
PC_FN Real pc_where_mass(PC_IO Slot m, uint i) {
  return pc_select(PC_LD(contact_rows, m, ROW_MASS + i) > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
}
PC_FN void pc_renew_masses(PC_IO Slot m, Responses r) {
  Real k = PC_LD(contact_rows, m, ROW_K);
  pc_store_masses(PC_PASS m, r, pc_where_mass(PC_PASS m, 0u), pc_where_mass(PC_PASS m, 1u),
                  pc_where_mass(PC_PASS m, 2u), pc_where_mass(PC_PASS m, 3u));
  // contact_solve goes on leaving alone what it left alone
  PC_ST(contact_rows, m, ROW_K, pc_select(k > PC_REAL(0.0), PC_LD(contact_rows, m, ROW_K), k));
}
#endif
