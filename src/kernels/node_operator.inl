// A node's row of node_operator, in quads: W (six rows) with D^-1 in the fourth reals; d and the arm to the pin; and the
// response G of its body to impulses on it, 6 x 6: linear part, then c, then angular part. Row 0 is all zeros: it passes
// everything on unchanged. Notation: tree_sweep.inl. Needs tree_math.inl.
// What of a node the ways need.
struct Link { Vec3 w0; Vec3 w1; Vec3 w2; Vec3 w3; Vec3 w4; Vec3 w5; Sym3 d_inverse; Vec3 d; Vec3 rc; };
PC_FN Link pc_link(PC_IO Index node) {
  Row row = PC_ROW(node_operator, node);
  Quad q0 = PC_ROW_QUAD(node_operator, row, 0u); Quad q1 = PC_ROW_QUAD(node_operator, row, 1u); Quad q2 = PC_ROW_QUAD(node_operator, row, 2u);
  Quad q3 = PC_ROW_QUAD(node_operator, row, 3u); Quad q4 = PC_ROW_QUAD(node_operator, row, 4u); Quad q5 = PC_ROW_QUAD(node_operator, row, 5u);
  Quad q6 = PC_ROW_QUAD(node_operator, row, 6u); Quad q7 = PC_ROW_QUAD(node_operator, row, 7u);
  Link n; n.w0 = q0.v; n.w1 = q1.v; n.w2 = q2.v; n.w3 = q3.v; n.w4 = q4.v; n.w5 = q5.v;
  n.d_inverse = pc_sym3(q0.s, q1.s, q2.s, q3.s, q4.s, q5.s); n.d = q6.v; n.rc = q7.v; return n;
}
PC_FN Sym6 pc_response(PC_IO Index node) {
  Row row = PC_ROW(node_operator, node);
  Quad q6 = PC_ROW_QUAD(node_operator, row, 6u); Quad q7 = PC_ROW_QUAD(node_operator, row, 7u); Quad q8 = PC_ROW_QUAD(node_operator, row, 8u);
  Quad q9 = PC_ROW_QUAD(node_operator, row, 9u); Quad q10 = PC_ROW_QUAD(node_operator, row, 10u); Quad q11 = PC_ROW_QUAD(node_operator, row, 11u); Quad q12 = PC_ROW_QUAD(node_operator, row, 12u);
  Sym6 g; g.l = pc_sym3(q6.s, q7.s, q8.v.x, q8.v.y, q8.v.z, q8.s); g.c = pc_mat3(q9.v, q10.v, q11.v); g.a = pc_sym3(q9.s, q10.s, q11.s, q12.v.x, q12.v.y, q12.v.z); return g;
}
// How the body moves when its parent moves by x and it turns by `turn` about the joint besides.
PC_FN Six pc_down(Link n, Six x, Vec3 turn) {
  precise Vec3 l = x.l + pc_cross(x.a, n.d);
  Vec3 own = pc_combine(n.w0, l.x, n.w1, l.y, n.w2, l.z); Vec3 other = pc_combine(n.w3, x.a.x, n.w4, x.a.y, n.w5, x.a.z);
  precise Vec3 q = turn - (own + other);
  return pc_six(pc_add(l, pc_cross(n.rc, q)), pc_add(x.a, q));
}
// What of impulses f on the body turns the joint, and what the parent feels of them.
PC_FN Vec3 pc_on_joint(Link n, Six f) { precise Vec3 t = f.a + pc_cross(f.l, n.rc); return t; }
PC_FN Six pc_up(Link n, Six f, Vec3 t) {
  precise Vec3 l = f.l - Vec3(pc_dot(n.w0, t), pc_dot(n.w1, t), pc_dot(n.w2, t)); precise Vec3 a = f.a - Vec3(pc_dot(n.w3, t), pc_dot(n.w4, t), pc_dot(n.w5, t));
  precise Vec3 turn = a + pc_cross(n.d, l); return pc_six(l, turn);
}
// X g X^T, where X x = (l + a x r, a): of a response at one point that at another, r away.
PC_FN Sym6 pc_response_at(Sym6 g, Vec3 r) {
  // c + B A, B v = v x r
  Vec3 k0 = pc_cross(pc_row0(g.a), r); Vec3 k1 = pc_cross(pc_row1(g.a), r); Vec3 k2 = pc_cross(pc_row2(g.a), r);
  Sym6 p; p.c = pc_mat3(pc_add(g.c.a, Vec3(k0.x, k1.x, k2.x)), pc_add(g.c.b, Vec3(k0.y, k1.y, k2.y)), pc_add(g.c.c, Vec3(k0.z, k1.z, k2.z)));
  Vec3 b0 = pc_cross(g.c.a, r); Vec3 b1 = pc_cross(g.c.b, r); Vec3 b2 = pc_cross(g.c.c, r);        // columns of B c^T
  Vec3 f0 = pc_cross(p.c.a, r); Vec3 f1 = pc_cross(p.c.b, r); Vec3 f2 = pc_cross(p.c.c, r);        // rows of c' B^T
  precise Real xx = g.l.xx + b0.x + f0.x; precise Real xy = g.l.xy + b1.x + f0.y; precise Real xz = g.l.xz + b2.x + f0.z;
  precise Real yy = g.l.yy + b1.y + f1.y; precise Real yz = g.l.yz + b2.y + f1.z; precise Real zz = g.l.zz + b2.z + f2.z;
  p.l = pc_sym3(xx, xy, xz, yy, yz, zz); p.a = g.a; return p;
}
