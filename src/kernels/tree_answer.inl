// After tree_respond, where joints close loops: how each body answers impulses on it, root to leaves. With E = X
// G_parent X^T the parent's response seen at the body, Z = E W, M = W^T Z + D^-1:
//   G = (1 - S W^T) E (1 - S W^T)^T + S D^-1 S^T = E - S Z^T - Z S^T + S M S^T
#include "tree_rows.inl"
#include "node_answer.inl"

PC_FN void pc_store_response(PC_IO Index row, Mask exists, Sym6 g) {
  PC_SCATTER_IF(exists, node_response, row, 0u, pc_quad(Vec3(g.l.xx, g.l.xy, g.l.xz), g.l.yy));
  PC_SCATTER_IF(exists, node_response, row, 1u, pc_quad(g.c.a, g.l.yz));
  PC_SCATTER_IF(exists, node_response, row, 2u, pc_quad(g.c.b, g.l.zz));
  PC_SCATTER_IF(exists, node_response, row, 3u, pc_quad(g.c.c, g.a.xx));
  PC_SCATTER_IF(exists, node_response, row, 4u, pc_quad(Vec3(g.a.xy, g.a.xz, g.a.yy), g.a.yz));
  PC_SCATTER_IF(exists, node_response, row, 5u, pc_quad(pc_zero3(), g.a.zz));
}
// Three rows of a 3 x 3 product: rows x of the left times the matrix m.
PC_FN Mat3 pc_rows_times(Vec3 x0, Vec3 x1, Vec3 x2, Mat3 m) {
  return pc_mat3(pc_mat_tmul(m, x0), pc_mat_tmul(m, x1), pc_mat_tmul(m, x2));
}
PC_FN Mat3 pc_mat_add(Mat3 x, Mat3 y) { return pc_mat3(pc_add(x.a, y.a), pc_add(x.b, y.b), pc_add(x.c, y.c)); }

PC_FN Sym6 pc_node_response(PC_IO Slot n, Sym3 d_inverse, Vec3 d, Vec3 rc, Sym6 parent) {
  Sym6 e = pc_response_at(parent, d);
  Mat3 wl = pc_ldm_tree(PC_PASS n, TREE_W);
  Mat3 wa = pc_ldm_tree(PC_PASS n, TREE_W + 9u);
  Mat3 ct = pc_transpose(e.c);
  Mat3 zl =
      pc_mat_add(pc_rows_times(pc_row0(e.l), pc_row1(e.l), pc_row2(e.l), wl), pc_rows_times(e.c.a, e.c.b, e.c.c, wa));
  Mat3 za =
      pc_mat_add(pc_rows_times(ct.a, ct.b, ct.c, wl), pc_rows_times(pc_row0(e.a), pc_row1(e.a), pc_row2(e.a), wa));
  // M, symmetric
  Mat3 wlt = pc_transpose(wl);
  Mat3 wat = pc_transpose(wa);
  Mat3 zlt = pc_transpose(zl);
  Mat3 zat = pc_transpose(za);
  Sym3 m = pc_sym_add(d_inverse, pc_sym_add(pc_products(wlt.a, wlt.b, wlt.c, zlt.a, zlt.b, zlt.c),
                                            pc_products(wat.a, wat.b, wat.c, zat.a, zat.b, zat.c)));
  Sym6 g;
  // angular: E - Z - Z^T + M
  precise Real axx = e.a.xx - (za.a.x + za.a.x) + m.xx;
  precise Real axy = e.a.xy - (za.a.y + za.b.x) + m.xy;
  precise Real axz = e.a.xz - (za.a.z + za.c.x) + m.xz;
  precise Real ayy = e.a.yy - (za.b.y + za.b.y) + m.yy;
  precise Real ayz = e.a.yz - (za.b.z + za.c.y) + m.yz;
  precise Real azz = e.a.zz - (za.c.z + za.c.z) + m.zz;
  g.a = pc_sym3(axx, axy, axz, ayy, ayz, azz);
  // mixed: E - Z_l + R (M - Z_a^T), R v = rc x v; columns of the product are rc x columns (rows of its transpose)
  Vec3 n0 = pc_cross(rc, pc_sub(pc_row0(m), za.a));
  Vec3 n1 = pc_cross(rc, pc_sub(pc_row1(m), za.b));
  Vec3 n2 = pc_cross(rc, pc_sub(pc_row2(m), za.c));
  precise Vec3 ca = e.c.a - zl.a + Vec3(n0.x, n1.x, n2.x);
  precise Vec3 cb = e.c.b - zl.b + Vec3(n0.y, n1.y, n2.y);
  precise Vec3 cc = e.c.c - zl.c + Vec3(n0.z, n1.z, n2.z);
  g.c = pc_mat3(ca, cb, cc);
  // linear: E - R Z_l^T + (R M - Z_l) R^T, of which r are the columns of R M, s those of R Z_l^T
  Vec3 r0 = pc_cross(rc, pc_row0(m));
  Vec3 r1 = pc_cross(rc, pc_row1(m));
  Vec3 r2 = pc_cross(rc, pc_row2(m));
  Vec3 q0 = pc_cross(rc, pc_sub(Vec3(r0.x, r1.x, r2.x), zl.a));
  Vec3 q1 = pc_cross(rc, pc_sub(Vec3(r0.y, r1.y, r2.y), zl.b));
  Vec3 q2 = pc_cross(rc, pc_sub(Vec3(r0.z, r1.z, r2.z), zl.c));
  Vec3 s0 = pc_cross(rc, zl.a);
  Vec3 s1 = pc_cross(rc, zl.b);
  Vec3 s2 = pc_cross(rc, zl.c);
  precise Real xx = e.l.xx - s0.x + q0.x;
  precise Real xy = e.l.xy - s1.x + q0.y;
  precise Real xz = e.l.xz - s2.x + q0.z;
  precise Real yy = e.l.yy - s1.y + q1.y;
  precise Real yz = e.l.yz - s2.y + q1.z;
  precise Real zz = e.l.zz - s2.z + q2.z;
  g.l = pc_sym3(xx, xy, xz, yy, yz, zz);
  return g;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Slot root = PC_NODE(m, t.first);
  // the factor is in units of the tree's mass
  Real total = PC_LD(tree_rows, root, TREE_TOTAL);
  Mask exists = total > PC_REAL(0.0);
  Real share = pc_inverse_or_zero(total);
  Sym6 h = pc_ldh_tree(PC_PASS root, TREE_H);
  Sym6 g =
      pc_sym6(pc_sym_scale(h.l, share), pc_mat3(pc_scale(h.c.a, share), pc_scale(h.c.b, share), pc_scale(h.c.c, share)),
              pc_sym_scale(h.a, share));
  PC_ONE pc_store_response(PC_PASS PC_ORDER(tree_order, root), exists, g);
  PC_MEET;
  PC_DOWN(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index own = PC_ORDER(tree_order, n);
    Index up = PC_ORDER(tree_order, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
    Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
    Vec3 d = pc_sub(pc_ld3_tree(PC_PASS n, TREE_RP), rc);
    Sym3 d_inverse = pc_sym_scale(pc_of_factor(pc_lds_tree(PC_PASS n, TREE_D)), share);
    pc_store_response(PC_PASS own, exists, pc_node_response(PC_PASS n, d_inverse, d, rc, pc_response(PC_PASS up)));
  }
}
