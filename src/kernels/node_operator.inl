// A node's row of node_operator, in quads: W (six rows) with the factor of D^-1 in the fourth reals; d and the arm to
// the pin. Row 0 is all zeros: it passes everything on unchanged. A root's row holds the factor of its answer H^-1.
// Notation: tree_sweep.inl. Needs tree_math.inl.
//
// Motions are kept in units in which inertias are 1: with D^-1 = F^T F the joint turns by F^T z, and a torque t on it
// changes z by F t. So how far an impulse reaches into a tree (F t with t = S^T f at each joint of the way) is also how
// what is pending there moves the place where it acts.
struct Link {
  Vec3 w0;
  Vec3 w1;
  Vec3 w2;
  Vec3 w3;
  Vec3 w4;
  Vec3 w5;
  Sym3 factor;
  Vec3 d;
  Vec3 rc;
};
PC_FN Link pc_link(PC_IO Index node) {
  Row row = PC_ROW(node_operator, node);
  Quad q0 = PC_ROW_QUAD(node_operator, row, 0u);
  Quad q1 = PC_ROW_QUAD(node_operator, row, 1u);
  Quad q2 = PC_ROW_QUAD(node_operator, row, 2u);
  Quad q3 = PC_ROW_QUAD(node_operator, row, 3u);
  Quad q4 = PC_ROW_QUAD(node_operator, row, 4u);
  Quad q5 = PC_ROW_QUAD(node_operator, row, 5u);
  Quad q6 = PC_ROW_QUAD(node_operator, row, 6u);
  Quad q7 = PC_ROW_QUAD(node_operator, row, 7u);
  Link n;
  n.w0 = q0.v;
  n.w1 = q1.v;
  n.w2 = q2.v;
  n.w3 = q3.v;
  n.w4 = q4.v;
  n.w5 = q5.v;
  n.factor = pc_sym3(q0.s, q1.s, q2.s, q3.s, q4.s, q5.s);
  n.d = q6.v;
  n.rc = q7.v;
  return n;
}
// [l 0; c a], with l and a lower triangles
PC_FN Sym6 pc_root_factor(PC_IO Index root) {
  Row row = PC_ROW(node_operator, root);
  Quad q0 = PC_ROW_QUAD(node_operator, row, 0u);
  Quad q1 = PC_ROW_QUAD(node_operator, row, 1u);
  Quad q2 = PC_ROW_QUAD(node_operator, row, 2u);
  Quad q3 = PC_ROW_QUAD(node_operator, row, 3u);
  Quad q4 = PC_ROW_QUAD(node_operator, row, 4u);
  Quad q5 = PC_ROW_QUAD(node_operator, row, 5u);
  Quad q6 = PC_ROW_QUAD(node_operator, row, 6u);
  return pc_sym6(pc_sym3(q3.v.x, q3.v.y, q3.v.z, q4.v.x, q4.v.y, q4.v.z), pc_mat3(q0.v, q1.v, q2.v),
                 pc_sym3(q5.v.x, q5.v.y, q5.v.z, q6.v.x, q6.v.y, q6.v.z));
}
// How the body moves when its parent moves by x and it turns by `turn` about the joint besides.
PC_FN Six pc_down(Link n, Six x, Vec3 turn) {
  precise Vec3 l = x.l + pc_cross(x.a, n.d);
  Vec3 own = pc_combine(n.w0, l.x, n.w1, l.y, n.w2, l.z);
  Vec3 other = pc_combine(n.w3, x.a.x, n.w4, x.a.y, n.w5, x.a.z);
  precise Vec3 q = turn - (own + other);
  return pc_six(pc_add(l, pc_cross(n.rc, q)), pc_add(x.a, q));
}
// What of impulses f on the body turns the joint, and what the parent feels of them.
PC_FN Vec3 pc_on_joint(Link n, Six f) {
  precise Vec3 t = f.a + pc_cross(f.l, n.rc);
  return t;
}
PC_FN Six pc_up(Link n, Six f, Vec3 t) {
  precise Vec3 l = f.l - Vec3(pc_dot(n.w0, t), pc_dot(n.w1, t), pc_dot(n.w2, t));
  precise Vec3 a = f.a - Vec3(pc_dot(n.w3, t), pc_dot(n.w4, t), pc_dot(n.w5, t));
  precise Vec3 turn = a + pc_cross(n.d, l);
  return pc_six(l, turn);
}
