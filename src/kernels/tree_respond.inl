// After tree_solve, where contacts or joints of loops touch trees: hands its factor on to them, as rows of
// node_operator; nothing is pending. The inverse inertia of the root is factored once more (node_operator.inl).
#include "tree_rows.inl"
#include "tree_store.inl"

// E with E E^T = m, of positive matrices that rounding may have made less: what is below the rounding of `bare`'s
// diagonal, that m is the rest of, answers nothing.
PC_FN Sym3 pc_cholesky(PC_IO Sym3 m, Sym3 bare) {
  Real none = PC_REAL(0.0);
  Real rounding = PC_INFO(rounding);
  precise Real least_x = bare.xx * rounding;
  precise Real least_y = bare.yy * rounding;
  precise Real least_z = bare.zz * rounding;
  Real xx = pc_sqrt(pc_select(m.xx > least_x, m.xx, none));
  Real ix = pc_inverse_or_zero(xx);
  precise Real xy = m.xy * ix;
  precise Real xz = m.xz * ix;
  precise Real rest_y = m.yy - xy * xy;
  Real yy = pc_sqrt(pc_select(rest_y > least_y, rest_y, none));
  Real iy = pc_inverse_or_zero(yy);
  precise Real yz = (m.yz - xy * xz) * iy;
  precise Real rest_z = m.zz - xz * xz - yz * yz;
  Real zz = pc_sqrt(pc_select(rest_z > least_z, rest_z, none));
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
// Row r of B with B E^T = c^T: E x = r, forwards.
PC_FN Vec3 pc_lower_solve(Sym3 e, Vec3 r) {
  precise Real x = r.x * pc_inverse_or_zero(e.xx);
  precise Real y = (r.y - e.xy * x) * pc_inverse_or_zero(e.yy);
  precise Real z = (r.z - e.xz * x - e.yz * y) * pc_inverse_or_zero(e.zz);
  return Vec3(x, y, z);
}
PC_FN void pc_nothing_pending(PC_IO Index row) {
  for (uint i = 0u; i < 4u; i++) PC_SCATTER(node_pending, row, i, pc_quad(pc_zero3(), PC_REAL(0.0)));
}
PC_FN void pc_hand_root(PC_IO Slot root, Index row, Mask exists, Real scale) {
  Sym6 h = pc_ldh_tree(PC_PASS root, TREE_H);
  Mat3 ct = pc_transpose(h.c);
  Sym3 l = pc_cholesky(PC_PASS h.l, h.l);
  Mat3 b = pc_mat3(pc_lower_solve(l, ct.a), pc_lower_solve(l, ct.b), pc_lower_solve(l, ct.c));
  Sym3 rest = pc_sym_sub(h.a, pc_products(b.a, b.b, b.c, b.a, b.b, b.c));
  Sym6 e = pc_sym6(pc_sym_scale(l, scale), pc_mat3(pc_scale(b.a, scale), pc_scale(b.b, scale), pc_scale(b.c, scale)),
                   pc_sym_scale(pc_cholesky(PC_PASS rest, h.a), scale));
  Real zero = PC_REAL(0.0);
  pc_sth_tree(PC_PASS root, TREE_ROOT_FACTOR, e);
  PC_SCATTER_IF(exists, node_operator, row, 0u, pc_quad(e.c.a, zero));
  PC_SCATTER_IF(exists, node_operator, row, 1u, pc_quad(e.c.b, zero));
  PC_SCATTER_IF(exists, node_operator, row, 2u, pc_quad(e.c.c, zero));
  PC_SCATTER_IF(exists, node_operator, row, 3u, pc_quad(Vec3(e.l.xx, e.l.xy, e.l.xz), zero));
  PC_SCATTER_IF(exists, node_operator, row, 4u, pc_quad(Vec3(e.l.yy, e.l.yz, e.l.zz), zero));
  PC_SCATTER_IF(exists, node_operator, row, 5u, pc_quad(Vec3(e.a.xx, e.a.xy, e.a.xz), zero));
  PC_SCATTER_IF(exists, node_operator, row, 6u, pc_quad(Vec3(e.a.yy, e.a.yz, e.a.zz), zero));
}
PC_FN void pc_hand_node(PC_IO Slot n, Index row, Mask exists, Real scale) {
  Sym3 e = pc_root_of_factor(pc_lds_tree(PC_PASS n, TREE_D), scale);
  Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
  Vec3 d = pc_sub(pc_ld3_tree(PC_PASS n, TREE_RP), rc);
  pc_sts_tree(PC_PASS n, TREE_FACTOR, e);
  PC_SCATTER_IF(exists, node_operator, row, 0u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W), e.xx));
  PC_SCATTER_IF(exists, node_operator, row, 1u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 3u), e.xy));
  PC_SCATTER_IF(exists, node_operator, row, 2u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 6u), e.xz));
  PC_SCATTER_IF(exists, node_operator, row, 3u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 9u), e.yy));
  PC_SCATTER_IF(exists, node_operator, row, 4u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 12u), e.yz));
  PC_SCATTER_IF(exists, node_operator, row, 5u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 15u), e.zz));
  PC_SCATTER_IF(exists, node_operator, row, 6u, pc_quad(d, PC_REAL(0.0)));
  PC_SCATTER_IF(exists, node_operator, row, 7u, pc_quad(rc, PC_REAL(0.0)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Slot root = PC_NODE(m, t.first);
  Real none = PC_REAL(0.0);
  // the factor is in units of the tree's mass
  Real total = PC_LD(tree_rows, root, TREE_TOTAL);
  Mask exists = total > none;
  Real share = pc_inverse_or_zero(total);
  Real scale = pc_sqrt(share);
  PC_ONE {
    PC_ST(tree_rows, root, TREE_ANEW, none);
    Index row = PC_ORDER(tree_order, root);
    pc_hand_root(PC_PASS root, row, exists, scale);
    pc_nothing_pending(PC_PASS row);
  }
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index row = PC_ORDER(tree_order, n);
    pc_hand_node(PC_PASS n, row, exists, scale);
    pc_nothing_pending(PC_PASS row);
  }
}
