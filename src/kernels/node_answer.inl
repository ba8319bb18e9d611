// A node's row of node_response: how its body answers impulses on it among its joints, 6 x 6. Needs tree_math.inl.
PC_FN Sym6 pc_response(PC_IO Index node) {
  Row row = PC_ROW(node_response, node);
  Quad q0 = PC_ROW_QUAD(node_response, row, 0u);
  Quad q1 = PC_ROW_QUAD(node_response, row, 1u);
  Quad q2 = PC_ROW_QUAD(node_response, row, 2u);
  Quad q3 = PC_ROW_QUAD(node_response, row, 3u);
  Quad q4 = PC_ROW_QUAD(node_response, row, 4u);
  Quad q5 = PC_ROW_QUAD(node_response, row, 5u);
  return pc_sym6(pc_sym3(q0.v.x, q0.v.y, q0.v.z, q0.s, q1.s, q2.s), pc_mat3(q1.v, q2.v, q3.v),
                 pc_sym3(q3.s, q4.v.x, q4.v.y, q4.v.z, q4.s, q5.s));
}
// X g X^T, where X x = (l + a x r, a): of a response at one point that at another, r away.
PC_FN Sym6 pc_response_at(Sym6 g, Vec3 r) {
  // c + B A, B v = v x r
  Vec3 k0 = pc_cross(pc_row0(g.a), r);
  Vec3 k1 = pc_cross(pc_row1(g.a), r);
  Vec3 k2 = pc_cross(pc_row2(g.a), r);
  Sym6 p;
  p.c = pc_mat3(pc_add(g.c.a, Vec3(k0.x, k1.x, k2.x)), pc_add(g.c.b, Vec3(k0.y, k1.y, k2.y)),
                pc_add(g.c.c, Vec3(k0.z, k1.z, k2.z)));
  // columns of B c^T
  Vec3 b0 = pc_cross(g.c.a, r);
  Vec3 b1 = pc_cross(g.c.b, r);
  Vec3 b2 = pc_cross(g.c.c, r);
  // rows of c' B^T
  Vec3 f0 = pc_cross(p.c.a, r);
  Vec3 f1 = pc_cross(p.c.b, r);
  Vec3 f2 = pc_cross(p.c.c, r);
  precise Real xx = g.l.xx + b0.x + f0.x;
  precise Real xy = g.l.xy + b1.x + f0.y;
  precise Real xz = g.l.xz + b2.x + f0.z;
  precise Real yy = g.l.yy + b1.y + f1.y;
  precise Real yz = g.l.yz + b2.y + f1.z;
  precise Real zz = g.l.zz + b2.z + f2.z;
  p.l = pc_sym3(xx, xy, xz, yy, yz, zz);
  p.a = g.a;
  return p;
}
