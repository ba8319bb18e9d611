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
  // of the turning about t1, t2 and n to the same impulses; and of (v1, v2, vn) to couples
  Vec3 w1;
  Vec3 w2;
  Vec3 wn;
  Sym3 a;  // of the turning to couples
};

// The smaller of the responses along the normal and along the tangents, of which it is the harmonic mean, whichever way
// they point. Zero says that the contact is left alone.
PC_FN Real pc_least_response(Sym3 l) {
  precise Real det = l.xx * l.yy - l.xy * l.xy;
  precise Real trace = l.xx + l.yy;
  precise Real tangents = PC_REAL(2.0) * det * pc_inverse_or_zero(trace);
  return pc_min(l.zz, pc_max(tangents, PC_REAL(0.0)));
}
#ifndef PC_FRICTIONLESS
// The friction block, the twist, and the response of everything else to them.
PC_FN void pc_store_friction_masses(PC_IO Slot m, Responses r) {
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
}
#endif
// What a point at (a, b) of the contact plane sees of a motion of the centre: of (v_n, w_1, w_2) along the normal.
PC_FN Real pc_seen_at(Vec3 motion, Real a, Real b) {
  precise Real seen = motion.x + b * motion.y - a * motion.z;
  return seen;
}
// The motion of the centre that a unit impulse of the normal row at (a, b) makes: K [1, b, -a].
PC_FN Vec3 pc_row_motion(Responses r, Real a, Real b) {
  precise Real vn = r.l.zz + r.w1.z * b - r.w2.z * a;
  precise Real w1 = r.w1.z + r.a.xx * b - r.a.xy * a;
  precise Real w2 = r.w2.z + r.a.xy * b - r.a.yy * a;
  return Vec3(vn, w1, w2);
}
PC_FN Real pc_row_mass(Vec3 motion, Real a, Real b, Real weight) {
  precise Real mass = pc_inverse_or_zero(pc_seen_at(motion, a, b)) * weight;
  return mass;
}
// Effective masses and the responses between rows; `w0` to `w3`: 1 where the point exists.
PC_FN void pc_store_masses(PC_IO Slot m, Responses r, Real w0, Real w1, Real w2, Real w3) {
#ifndef PC_FRICTIONLESS
  pc_store_friction_masses(PC_PASS m, r);
#endif
  pc_st_mass(ROW_K, pc_least_response(r.l));
  Real a0 = PC_LD(contact_rows, m, ROW_A);
  Real a1 = PC_LD(contact_rows, m, ROW_A + 1u);
  Real a2 = PC_LD(contact_rows, m, ROW_A + 2u);
  Real a3 = PC_LD(contact_rows, m, ROW_A + 3u);
  Real b0 = PC_LD(contact_rows, m, ROW_B);
  Real b1 = PC_LD(contact_rows, m, ROW_B + 1u);
  Real b2 = PC_LD(contact_rows, m, ROW_B + 2u);
  Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
  Vec3 u0 = pc_row_motion(r, a0, b0);
  Vec3 u1 = pc_row_motion(r, a1, b1);
  Vec3 u2 = pc_row_motion(r, a2, b2);
  Vec3 u3 = pc_row_motion(r, a3, b3);
  pc_st_mass(ROW_MASS, pc_row_mass(u0, a0, b0, w0));
  pc_st_mass(ROW_MASS + 1u, pc_row_mass(u1, a1, b1, w1));
  pc_st_mass(ROW_MASS + 2u, pc_row_mass(u2, a2, b2, w2));
  pc_st_mass(ROW_MASS + 3u, pc_row_mass(u3, a3, b3, w3));
  pc_st_mass(ROW_D, pc_seen_at(u0, a1, b1));
  pc_st_mass(ROW_D + 1u, pc_seen_at(u0, a2, b2));
  pc_st_mass(ROW_D + 2u, pc_seen_at(u0, a3, b3));
  pc_st_mass(ROW_D + 3u, pc_seen_at(u1, a2, b2));
  pc_st_mass(ROW_D + 4u, pc_seen_at(u1, a3, b3));
  pc_st_mass(ROW_D + 5u, pc_seen_at(u2, a3, b3));
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
