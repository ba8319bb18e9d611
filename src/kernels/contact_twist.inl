// Relative velocity of b against a at the manifold's centre, in the contact frame.
struct Twist {
  Real v1;
  Real v2;
  Real vn;
  Real w1;
  Real w2;
  Real wn;
};
PC_FN Twist pc_twist(BodyState a, BodyState b, Arms arms, Vec3 n, Vec3 t1, Vec3 t2) {
  Vec3 wa = pc_angular_velocity(a);
  Vec3 wb = pc_angular_velocity(b);
  Vec3 va = pc_add(a.v, pc_cross(wa, arms.a));
  Vec3 vb = pc_add(b.v, pc_cross(wb, arms.b));
  Vec3 v = pc_sub(vb, va);
  Vec3 w = pc_sub(wb, wa);
  Twist t;
  t.v1 = pc_dot(t1, v);
  t.v2 = pc_dot(t2, v);
  t.vn = pc_dot(n, v);
  t.w1 = pc_dot(t1, w);
  t.w2 = pc_dot(t2, w);
  t.wn = pc_dot(n, w);
  return t;
}
