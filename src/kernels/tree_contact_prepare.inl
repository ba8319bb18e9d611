// Once a sub-step, after tree_respond: the effective masses of a manifold with a body of a tree, from how whole trees
// answer. Within one tree an impulse on one body also moves the other: of that what the nearest common node passes on.
#include "body_state.inl"
#include "tree_math.inl"
#include "contact_way.inl"
#include "node_operator.inl"
#include "node_response.inl"
#include "contact_rows.inl"
#include "contact_arms.inl"
#include "contact_masses.inl"

struct Frame { Vec3 t1; Vec3 t2; Vec3 n; };
PC_FN Vec3 pc_in_frame(Frame f, Vec3 v) { return Vec3(pc_dot(f.t1, v), pc_dot(f.t2, v), pc_dot(f.n, v)); }
PC_FN Sym3 pc_sym_in_frame(Frame f, Sym3 m) { Vec3 a = pc_sym_mul(m, f.t1); Vec3 b = pc_sym_mul(m, f.t2); Vec3 c = pc_sym_mul(m, f.n); return pc_products(f.t1, f.t2, f.n, a, b, c); }

// How body b of a tree moves, at its arm and in the contact frame, when body a of it feels the impulses f; a tenth is left out.
PC_FN Six pc_across_in_frame(PC_IO Way w, Slot m, Frame frame, Arms arms, Six f) {
  Six x = pc_across(PC_PASS w, m, f);
  precise Vec3 xl = pc_in_frame(frame, pc_add(x.l, pc_cross(x.a, arms.b))) * PC_REAL(0.9); precise Vec3 xa = pc_in_frame(frame, x.a) * PC_REAL(0.9);
  return pc_six(xl, xa);
}

// Takes the share of an impulse (or couple) along axis i of the frame, felt by both bodies of one tree, out of the responses.
PC_FN void pc_take_across(PC_INOUT(Responses) r, Six x0, Six x1, Six x2, Six y0, Six y1, Six y2) {
  precise Real lxx = r.l.xx - (x0.l.x + x0.l.x); precise Real lxy = r.l.xy - (x1.l.x + x0.l.y); precise Real lxz = r.l.xz - (x2.l.x + x0.l.z);
  precise Real lyy = r.l.yy - (x1.l.y + x1.l.y); precise Real lyz = r.l.yz - (x2.l.y + x1.l.z); precise Real lzz = r.l.zz - (x2.l.z + x2.l.z);
  r.l = pc_sym3(lxx, lxy, lxz, lyy, lyz, lzz);
  precise Real axx = r.a.xx - (y0.a.x + y0.a.x); precise Real axy = r.a.xy - (y1.a.x + y0.a.y); precise Real axz = r.a.xz - (y2.a.x + y0.a.z);
  precise Real ayy = r.a.yy - (y1.a.y + y1.a.y); precise Real ayz = r.a.yz - (y2.a.y + y1.a.z); precise Real azz = r.a.zz - (y2.a.z + y2.a.z);
  r.a = pc_sym3(axx, axy, axz, ayy, ayz, azz);
  precise Vec3 w1 = r.w1 - (Vec3(x0.a.x, x1.a.x, x2.a.x) + y0.l); precise Vec3 w2 = r.w2 - (Vec3(x0.a.y, x1.a.y, x2.a.y) + y1.l); precise Vec3 wn = r.wn - (Vec3(x0.a.z, x1.a.z, x2.a.z) + y2.l);
  r.w1 = w1; r.w2 = w2; r.wn = wn;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY)); Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Quad moved_a = PC_GATHER(delta, ia, 0u); Quad moved_b = PC_GATHER(delta, ib, 0u); Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  Frame frame; frame.n = pc_ld3_rows(PC_PASS m, ROW_N); frame.t1 = pc_ld3_rows(PC_PASS m, ROW_T); frame.t2 = pc_cross(frame.n, frame.t1);
  Sym6 side_a = pc_side_response(PC_PASS w, m, 0u, ia, arms.a);
  Sym6 side_b = pc_side_response(PC_PASS w, m, 1u, ib, arms.b);
  Sym6 both = pc_sym6_add(side_a, side_b);
  Responses r; r.l = pc_sym_in_frame(frame, both.l); r.a = pc_sym_in_frame(frame, both.a);
  Vec3 c1 = pc_in_frame(frame, pc_mat_tmul(both.c, frame.t1)); Vec3 c2 = pc_in_frame(frame, pc_mat_tmul(both.c, frame.t2)); Vec3 cn = pc_in_frame(frame, pc_mat_tmul(both.c, frame.n));
  r.w1 = Vec3(c1.x, c2.x, cn.x); r.w2 = Vec3(c1.y, c2.y, cn.y); r.wn = Vec3(c1.z, c2.z, cn.z);
  if (w.below_a + w.below_b > 0u) {  // lint: allow (the same for all lanes; where a contact is not within one tree it takes out zeros)
    Vec3 zero = pc_zero3();
    Six x0 = pc_across_in_frame(PC_PASS w, m, frame, arms, pc_six(frame.t1, pc_cross(arms.a, frame.t1))); Six x1 = pc_across_in_frame(PC_PASS w, m, frame, arms, pc_six(frame.t2, pc_cross(arms.a, frame.t2))); Six x2 = pc_across_in_frame(PC_PASS w, m, frame, arms, pc_six(frame.n, pc_cross(arms.a, frame.n)));
    Six y0 = pc_across_in_frame(PC_PASS w, m, frame, arms, pc_six(zero, frame.t1)); Six y1 = pc_across_in_frame(PC_PASS w, m, frame, arms, pc_six(zero, frame.t2)); Six y2 = pc_across_in_frame(PC_PASS w, m, frame, arms, pc_six(zero, frame.n));
    pc_take_across(r, x0, x1, x2, y0, y1, y2);
  }
  Real one = PC_REAL(1.0); Real none = PC_REAL(0.0);
  Real w0 = pc_select(PC_LD(contact_rows, m, ROW_MASS) > none, one, none); Real w1 = pc_select(PC_LD(contact_rows, m, ROW_MASS + 1u) > none, one, none);
  Real w2 = pc_select(PC_LD(contact_rows, m, ROW_MASS + 2u) > none, one, none); Real w3 = pc_select(PC_LD(contact_rows, m, ROW_MASS + 3u) > none, one, none);
  pc_store_masses(PC_PASS m, r, w0, w1, w2, w3);
  precise Real light = pc_body_state(PC_PASS ia).inverse_mass + pc_body_state(PC_PASS ib).inverse_mass; precise Real most = pc_inverse_or_zero(light) * PC_REAL(1000.0);
  for (uint i = 0u; i < 4u; i++) PC_ST(contact_rows, m, ROW_MASS + i, pc_min(PC_LD(contact_rows, m, ROW_MASS + i), most));
  precise Real trace = PC_LD(contact_rows, m, ROW_TT) + PC_LD(contact_rows, m, ROW_TT + 2u); Real less = pc_select(trace > most, pc_div(most, pc_max(trace, most)), one);
  for (uint i = 0u; i < 3u; i++) { precise Real block = PC_LD(contact_rows, m, ROW_TT + i) * less; PC_ST(contact_rows, m, ROW_TT + i, block); }
  PC_ST(contact_rows, m, ROW_SCALE, one);
  for (uint i = 0u; i < 4u; i++) {  // the slow means
    Real mean = PC_LD(contact_impulses, m, IMPULSE_MEAN + i); precise Real next = mean + (PC_LD(contact_impulses, m, i) - mean) * PC_INFO(mean_share); PC_ST(contact_impulses, m, IMPULSE_MEAN + i, next);
  }
}
