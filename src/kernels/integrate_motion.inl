// What forces and drag make of velocities in a sub-step. With F the drag, a the acceleration:
//   u' = u + a h phi(F h) - (1 - e^(-F h)) u,   L' = L + T h phi(G h) - (1 - e^(-G h)) L
// which is exact for constant a, T (errata vi of the method).
// Both are sums of two reals, as positions are: a velocity in one float takes up g h with the rounding of its own
// last place, the same way each time. Without drag (PC_DRAG not defined) phi = 1: the same bits, less work.
PC_FN void pc_integrate(PC_IO PC_INOUT(BodyMotion) m, BodyForce f) {
  Real h = PC_INFO(h);
  Mask dynamic_body = m.linear.s > PC_REAL(0.0);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 acceleration = pc_madd(gravity, f.push.v, m.linear.s);
#ifdef PC_DRAG
  precise Real x = f.push.s * h;
  precise Real y = f.turn.s * h;
  precise Real kick = f.slow.phi * h;
  precise Real twist = f.calm.phi * h;
  Share u_share = pc_share(x, m.linear.v, m.linear_low.v, f.slow);
  Share l_share = pc_share(y, m.angular.v, m.angular_low.v, f.calm);
  precise Vec3 u_change = (acceleration * kick - u_share.gone) + u_share.low;
  precise Vec3 l_change = (f.turn.v * twist - l_share.gone) + l_share.low;
  m.linear.v = pc_select3(dynamic_body, u_share.kept, m.linear.v);
  m.angular.v = pc_select3(dynamic_body, l_share.kept, m.angular.v);
#else
  precise Vec3 u_change = acceleration * h + m.linear_low.v;
  precise Vec3 l_change = f.turn.v * h + m.angular_low.v;
#endif
  TwoSum u = pc_two_sum(m.linear.v, u_change);
  TwoSum l = pc_two_sum(m.angular.v, l_change);
  m.linear.v = pc_select3(dynamic_body, pc_snap3(u.sum), m.linear.v);
  m.angular.v = pc_select3(dynamic_body, pc_snap3(l.sum), m.angular.v);
  m.linear_low.v = pc_select3(dynamic_body, pc_snap3(u.low), m.linear_low.v);
  m.angular_low.v = pc_select3(dynamic_body, pc_snap3(l.low), m.angular_low.v);
  m.angular.s = PC_REAL(0.0);
}
