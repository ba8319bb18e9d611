// After tree_solve, where contacts or joints of loops touch trees: hands its factor on to them, as rows of node_operator; nothing is
// pending. The inverse inertias of joints and roots are factored once more (node_operator.inl).
//
// A free tree that has hardly turned since the first sub-step of the step keeps what it handed on (PC_INFO(kept_turn)), joint by joint, and contacts
// keep how they reach into it: in a pile at rest that is nearly all of them. Pins and limits do not go by it: tree_solve and tree_again use the
// factor of now.
#include "tree_rows.inl"
#include "tree_store.inl"

const uint TREE_ANEW = TREE_PUSH_SPEED;  // 1 where contacts on the body must reach anew; until tree_again

// E with E E^T = m, of positive matrices that rounding may have made less: what is below the rounding of `bare`'s diagonal, that m is the rest of,
// answers nothing.
PC_FN Sym3 pc_cholesky(PC_IO Sym3 m, Sym3 bare) {
  Real none = PC_REAL(0.0); Real rounding = PC_INFO(rounding);
  precise Real least_x = bare.xx * rounding; precise Real least_y = bare.yy * rounding; precise Real least_z = bare.zz * rounding;
  Real xx = pc_sqrt(pc_select(m.xx > least_x, m.xx, none)); Real ix = pc_inverse_or_zero(xx);
  precise Real xy = m.xy * ix; precise Real xz = m.xz * ix;
  precise Real rest_y = m.yy - xy * xy; Real yy = pc_sqrt(pc_select(rest_y > least_y, rest_y, none)); Real iy = pc_inverse_or_zero(yy);
  precise Real yz = (m.yz - xy * xz) * iy;
  precise Real rest_z = m.zz - xz * xz - yz * yz; Real zz = pc_sqrt(pc_select(rest_z > least_z, rest_z, none));
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
// Row r of B with B E^T = c^T: E x = r, forwards.
PC_FN Vec3 pc_lower_solve(Sym3 e, Vec3 r) {
  precise Real x = r.x * pc_inverse_or_zero(e.xx); precise Real y = (r.y - e.xy * x) * pc_inverse_or_zero(e.yy); precise Real z = (r.z - e.xz * x - e.yz * y) * pc_inverse_or_zero(e.zz);
  return Vec3(x, y, z);
}
// Of the lanes where it is made.
PC_FN void pc_keep_factor(PC_IO Slot n, uint f, Mask made, Sym3 e) { pc_sts_tree(PC_PASS n, f, pc_sym_select(made, e, pc_lds_tree(PC_PASS n, f))); }
PC_FN void pc_nothing_pending(PC_IO Index row) {
  for (uint i = 0u; i < 4u; i++) PC_SCATTER(node_pending, row, i, pc_quad(pc_zero3(), PC_REAL(0.0)));
}
// Tells contacts on the body whether they must reach anew.
PC_FN void pc_tell_anew(PC_IO Slot n, Index row, Mask exists, Real anew) {
  Quad arm = PC_GATHER(node_operator, row, 7u); PC_SCATTER_IF(exists, node_operator, row, 7u, pc_quad(arm.v, anew)); PC_ST(tree_rows, n, TREE_ANEW, anew);
}

PC_FN void pc_hand_root(PC_IO Slot root, Index row, Mask made, Real scale) {
  Sym6 h = pc_ldh_tree(PC_PASS root, TREE_H); Mat3 ct = pc_transpose(h.c);
  Sym3 l = pc_cholesky(PC_PASS h.l, h.l); Mat3 b = pc_mat3(pc_lower_solve(l, ct.a), pc_lower_solve(l, ct.b), pc_lower_solve(l, ct.c));
  Sym3 rest = pc_sym_sub(h.a, pc_products(b.a, b.b, b.c, b.a, b.b, b.c));
  Sym6 e; e.l = pc_sym_scale(l, scale); e.c = pc_mat3(pc_scale(b.a, scale), pc_scale(b.b, scale), pc_scale(b.c, scale)); e.a = pc_sym_scale(pc_cholesky(PC_PASS rest, h.a), scale);
  pc_keep_factor(PC_PASS root, TREE_ROOT_FACTOR, made, e.l); pc_keep_factor(PC_PASS root, TREE_ROOT_FACTOR + 15u, made, e.a); Mat3 c = pc_ldm_tree(PC_PASS root, TREE_ROOT_FACTOR + 6u); Real zero = PC_REAL(0.0);
  pc_stm_tree(PC_PASS root, TREE_ROOT_FACTOR + 6u, pc_mat3(pc_select3(made, e.c.a, c.a), pc_select3(made, e.c.b, c.b), pc_select3(made, e.c.c, c.c)));
  PC_SCATTER_IF(made, node_operator, row, 0u, pc_quad(e.c.a, zero)); PC_SCATTER_IF(made, node_operator, row, 1u, pc_quad(e.c.b, zero)); PC_SCATTER_IF(made, node_operator, row, 2u, pc_quad(e.c.c, zero));
  PC_SCATTER_IF(made, node_operator, row, 3u, pc_quad(Vec3(e.l.xx, e.l.xy, e.l.xz), zero)); PC_SCATTER_IF(made, node_operator, row, 4u, pc_quad(Vec3(e.l.yy, e.l.yz, e.l.zz), zero));
  PC_SCATTER_IF(made, node_operator, row, 5u, pc_quad(Vec3(e.a.xx, e.a.xy, e.a.xz), zero)); PC_SCATTER_IF(made, node_operator, row, 6u, pc_quad(Vec3(e.a.yy, e.a.yz, e.a.zz), zero));
}
PC_FN void pc_hand_node(PC_IO Slot n, Index row, Mask made, Real scale) {
  Sym3 inverse = pc_lds_tree(PC_PASS n, TREE_D); Sym3 e = pc_sym_scale(pc_cholesky(PC_PASS inverse, inverse), scale);
  Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC); Vec3 d = pc_sub(pc_ld3_tree(PC_PASS n, TREE_RP), rc); pc_keep_factor(PC_PASS n, TREE_FACTOR, made, e);
  PC_SCATTER_IF(made, node_operator, row, 0u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W), e.xx));
  PC_SCATTER_IF(made, node_operator, row, 1u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 3u), e.xy));
  PC_SCATTER_IF(made, node_operator, row, 2u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 6u), e.xz));
  PC_SCATTER_IF(made, node_operator, row, 3u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 9u), e.yy));
  PC_SCATTER_IF(made, node_operator, row, 4u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 12u), e.yz));
  PC_SCATTER_IF(made, node_operator, row, 5u, pc_quad(pc_ld3_tree(PC_PASS n, TREE_W + 15u), e.zz));
  PC_SCATTER_IF(made, node_operator, row, 6u, pc_quad(d, PC_REAL(0.0))); PC_SCATTER_IF(made, node_operator, row, 7u, pc_quad(rc, PC_REAL(0.0)));
}

// 1 where `now` is not `kept`, by more than a tenth.
PC_FN Real pc_is_other(Real now, Real kept) {
  precise Real least = kept * PC_REAL(0.9); precise Real most = kept * PC_REAL(1.1);
  Mask same = pc_and(pc_and(now > least, now < most), kept > PC_REAL(1e-30));  // (less could be subnormal)
  return pc_select(same, PC_REAL(0.0), PC_REAL(1.0));
}
// 1 where the joint's D^-1 is another than that which was handed on, by its determinant. A limit that begins or ends to act changes it many times over.
PC_FN Real pc_is_changed(PC_IO Slot n, Real share) {
  Sym3 now = pc_sym_scale(pc_lds_tree(PC_PASS n, TREE_D), share);
  precise Real xx = now.yy * now.zz - now.yz * now.yz; precise Real xy = now.yz * now.xz - now.xy * now.zz; precise Real xz = now.xy * now.yz - now.yy * now.xz;
  precise Real det = now.xx * xx + now.xy * xy + now.xz * xz;
  precise Real root = PC_LD(tree_rows, n, TREE_FACTOR) * PC_LD(tree_rows, n, TREE_FACTOR + 3u) * PC_LD(tree_rows, n, TREE_FACTOR + 5u); precise Real kept = root * root;
  return pc_is_other(det, kept);
}
// The same of the root's H^-1, by its traces.
PC_FN Real pc_is_root_changed(PC_IO Slot root, Real share) {
  Sym6 h = pc_ldh_tree(PC_PASS root, TREE_H); Sym6 e = pc_ldh_tree(PC_PASS root, TREE_ROOT_FACTOR);
  precise Real push = (h.l.xx + h.l.yy + h.l.zz) * share; precise Real turn = (h.a.xx + h.a.yy + h.a.zz) * share;
  precise Real kept_push = e.l.xx * e.l.xx + e.l.xy * e.l.xy + e.l.xz * e.l.xz + e.l.yy * e.l.yy + e.l.yz * e.l.yz + e.l.zz * e.l.zz;
  precise Real own = e.a.xx * e.a.xx + e.a.xy * e.a.xy + e.a.xz * e.a.xz + e.a.yy * e.a.yy + e.a.yz * e.a.yz + e.a.zz * e.a.zz;
  precise Real kept_turn = own + pc_dot(e.c.a, e.c.a) + pc_dot(e.c.b, e.c.b) + pc_dot(e.c.c, e.c.c);
  return pc_max(pc_is_other(push, kept_push), pc_is_other(turn, kept_turn));
}
// 1 where a tree must hand on all that it is now. Its bodies have turned since the sub-step before by about as much as they would in this one.
PC_FN Real pc_is_outdated(PC_IO Slot m, Tree t, Real share) {
  Slot root = PC_NODE(m, t.first); Real square = PC_REAL(0.0);
  PC_NODES(k, 0u, t) { Vec3 half_turn = pc_ld3_tree(PC_PASS PC_NODE(m, t.first + k), TREE_TURN); square = pc_max(square, pc_dot(half_turn, half_turn)); }
  PC_MOST(square);
  precise Real turned = PC_LD(tree_rows, root, TREE_TURNED) + pc_sqrt(square) * PC_REAL(2.0);
  Mask free = PC_LD(tree_rows, root, TREE_MASS) > PC_REAL(0.0);
  Mask same = pc_and(free, pc_and(turned < PC_INFO(kept_turn), pc_is_root_changed(PC_PASS root, share) < PC_REAL(0.5)));
  PC_MEET; PC_ONE PC_ST(tree_rows, root, TREE_TURNED, pc_select(same, turned, PC_REAL(0.0)));
  return pc_select(same, PC_REAL(0.0), PC_REAL(1.0));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m); Slot root = PC_NODE(m, t.first); Real none = PC_REAL(0.0);
  // the factor is in units of the tree's mass
  Real total = PC_LD(tree_rows, root, TREE_TOTAL); Mask exists = total > none; Real share = pc_inverse_or_zero(total); Real scale = pc_sqrt(share);
  Real all = pc_is_outdated(PC_PASS m, t, share); Index first = PC_ORDER(tree_order, root); Mask made = pc_and(exists, all > none);
  PC_ONE {
    if (PC_ANY(made)) pc_hand_root(PC_PASS root, first, made, scale);  // lint: allow (what it stores is of other lanes)
    pc_tell_anew(PC_PASS root, first, exists, all); pc_nothing_pending(PC_PASS first);
  }
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k); Index row = PC_ORDER(tree_order, n); Real own = pc_max(all, pc_is_changed(PC_PASS n, share)); Mask here = pc_and(exists, own > none);
    if (PC_ANY(here)) pc_hand_node(PC_PASS n, row, here, scale);  // lint: allow (as above)
    PC_ST(tree_rows, n, TREE_ANEW, own); pc_nothing_pending(PC_PASS row);
  }
  PC_MEET;
  PC_DOWN(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k); Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    pc_tell_anew(PC_PASS n, PC_ORDER(tree_order, n), exists, pc_max(PC_LD(tree_rows, n, TREE_ANEW), PC_LD(tree_rows, up, TREE_ANEW)));
  }
}
