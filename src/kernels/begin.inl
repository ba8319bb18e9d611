// Start of a step. The stored velocity u is half a sub-step behind the position: u(t) = v(t - h/2).
// * A velocity that was just set is in phase: u = (phi v + a h (phi2 - phi)) / e, so that the first sub-step's
//   u' = e u + a h phi is the exact mean velocity phi v + a h phi2 of motion under constant force and drag
//   (without drag: u = v - a h / 2, the half kick; Hairer, Lubich, Wanner, Geometric Numerical Integration I.1).
// * When the sub-step changes from h0 to h: u shifts by (h0 - h) / (2 h0) of the last sub-step's change.
#include "world_inertia.inl"

PC_FN Vec3 pc_staggered(Vec3 v, Vec3 a, Real drag, Real h) {
  precise Real x = drag * h;
  Decay d = pc_decay(x);
  precise Real kick = (d.phi2 - d.phi) * h;
  precise Vec3 numerator = v * d.phi + a * kick;
  return pc_scale(numerator, pc_div(PC_REAL(1.0), d.e));
}

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad push = PC_GATHER(force, i, 0u);
  Quad turn = PC_GATHER(force, i, 1u);
  Quad linear_change = PC_GATHER(half_change, i, 0u);
  Quad angular_change = PC_GATHER(half_change, i, 1u);
  Real h = PC_INFO(h);

  Mask dynamic_body = linear.s > PC_REAL(0.0);
  Mask in_phase = pc_and(angular.s < PC_REAL(0.0), dynamic_body);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 acceleration = pc_madd(gravity, push.v, linear.s);
  Vec3 u = pc_staggered(linear.v, acceleration, push.s, h);
  Vec3 l = pc_staggered(angular.v, turn.v, turn.s, h);
  Vec3 u_shifted = pc_madd(linear.v, linear_change.v, PC_INFO(h_change));
  Vec3 l_shifted = pc_madd(angular.v, angular_change.v, PC_INFO(h_change));
  linear.v = pc_select3(in_phase, u, u_shifted);
  angular.v = pc_select3(in_phase, l, l_shifted);
  angular.s = PC_REAL(0.0);
  PC_SCATTER(motion, i, 0u, linear);
  PC_SCATTER(motion, i, 1u, angular);

  PC_SCATTER(delta, i, 0u, pc_quad(pc_zero3(), PC_REAL(0.0)));
  PC_SCATTER(delta, i, 1u, pc_quad(pc_zero3(), PC_REAL(0.0)));
  pc_store_inertia(PC_PASS i, linear.s);
}
