// Stage 1 of a sub-step: forces and drag. With F the drag, a the acceleration:
//   u' = u + a h phi(F h) - (1 - e^(-F h)) u,   L' = L + T h phi(G h) - (1 - e^(-G h)) L
// which is exact for constant a, T (errata vi of the method).
// Both are sums of two reals, as positions are: a velocity in one float takes up g h with the rounding of its own
// last place, the same way each time. Without drag (PC_DRAG not defined) phi = 1: the same bits, less work.

#ifdef PC_DRAG
#include "drag_share.inl"
#ifdef PC_SEED
// The original's f = 1 - F h, and 0 where that would turn a velocity round: it never grows.
PC_FN Decay pc_slowing(Real drag_times_h) {
  Decay d; d.loss = pc_min(drag_times_h, PC_REAL(1.0)); precise Real left = PC_REAL(1.0) - d.loss;
  d.e = left; d.phi = PC_REAL(1.0); d.phi2 = PC_REAL(0.5); return d;
}
#endif
#endif

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad linear_low = PC_GATHER(velocity_parts, i, 2u);
  Quad angular_low = PC_GATHER(velocity_parts, i, 3u);
  Quad push = PC_GATHER(force, i, 0u);
  Quad turn = PC_GATHER(force, i, 1u);
  Real h = PC_INFO(h);

  Mask dynamic_body = linear.s > PC_REAL(0.0);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 acceleration = pc_madd(gravity, push.v, linear.s);
#ifdef PC_DRAG
  precise Real x = push.s * h;
  precise Real y = turn.s * h;
#ifdef PC_SEED
  Decay slow = pc_slowing(x); Decay calm = pc_slowing(y);
#else
  Decay slow = pc_decay_of(PC_GATHER(drag_terms, i, 0u)); Decay calm = pc_decay_of(PC_GATHER(drag_terms, i, 1u));
#endif
  precise Real kick = slow.phi * h;
  precise Real twist = calm.phi * h;
  Share u_share = pc_share(x, linear.v, linear_low.v, slow);
  Share l_share = pc_share(y, angular.v, angular_low.v, calm);
  precise Vec3 u_change = (acceleration * kick - u_share.gone) + u_share.low;
  precise Vec3 l_change = (turn.v * twist - l_share.gone) + l_share.low;
  linear.v = pc_select3(dynamic_body, u_share.kept, linear.v);
  angular.v = pc_select3(dynamic_body, l_share.kept, angular.v);
#else
  precise Vec3 u_change = acceleration * h + linear_low.v;
  precise Vec3 l_change = turn.v * h + angular_low.v;
#endif
  TwoSum u = pc_two_sum(linear.v, u_change);
  TwoSum l = pc_two_sum(angular.v, l_change);
  linear.v = pc_select3(dynamic_body, pc_snap3(u.sum), linear.v);
  angular.v = pc_select3(dynamic_body, pc_snap3(l.sum), angular.v);
  linear_low.v = pc_select3(dynamic_body, pc_snap3(u.low), linear_low.v);
  angular_low.v = pc_select3(dynamic_body, pc_snap3(l.low), angular_low.v);
  angular.s = PC_REAL(0.0);
  PC_SCATTER(motion, i, 0u, linear);
  PC_SCATTER(motion, i, 1u, angular);
  PC_SCATTER(velocity_parts, i, 2u, linear_low);
  PC_SCATTER(velocity_parts, i, 3u, angular_low);
}
