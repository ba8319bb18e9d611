// Start of a step. The stored velocity u is half a sub-step behind the position (stagger.inl).
#include "stagger.inl"
#ifdef PC_DRAG
#include "drag_share.inl"
#endif

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
#ifndef PC_SEED
  Quad push = PC_GATHER(force, i, 0u);
  Quad turn = PC_GATHER(force, i, 1u);
#endif
  Quad linear_change = PC_GATHER(velocity_parts, i, 0u);
  Quad angular_change = PC_GATHER(velocity_parts, i, 1u);
  Quad linear_low = PC_GATHER(velocity_parts, i, 2u);
  Quad angular_low = PC_GATHER(velocity_parts, i, 3u);

  Mask dynamic_body = linear.s > PC_REAL(0.0); Mask in_phase = pc_and(angular.s < PC_REAL(0.0), dynamic_body);
#ifdef PC_SEED
  VelocityShift shift; shift.u = pc_shift(PC_PASS in_phase, linear.v, linear_change.v); shift.l = pc_shift(PC_PASS in_phase, angular.v, angular_change.v);
#else
  VelocityShift shift = pc_velocity_shift(PC_PASS linear, angular, linear_change, angular_change, push, turn);
#endif
  pc_add_shift(dynamic_body, shift.u, linear.v, linear_low.v); pc_add_shift(dynamic_body, shift.l, angular.v, angular_low.v);
  precise Real settling = angular_low.s - PC_REAL(1.0); angular_low.s = pc_max(settling, PC_REAL(0.0));
  angular.s = pc_select(in_phase, angular.s, PC_REAL(0.0));  // so far, that `synchronise` knows a first sub-step
  PC_SCATTER(motion, i, 0u, linear);
  PC_SCATTER(motion, i, 1u, angular);
  PC_SCATTER(velocity_parts, i, 2u, linear_low);
  PC_SCATTER(velocity_parts, i, 3u, angular_low);

#ifdef PC_DRAG
  // of all sub-steps, which are of one length
  Real h = PC_INFO(h); precise Real x = push.s * h; precise Real y = turn.s * h;
  Decay slow = pc_decay(x); Decay calm = slow;
  if (PC_ANY(pc_or(x < y, y < x))) calm = pc_decay(y);  // lint: allow (equal ones give the same)
  PC_SCATTER(drag_terms, i, 0u, pc_terms_of(slow));
  PC_SCATTER(drag_terms, i, 1u, pc_terms_of(calm));
#endif
  PC_SCATTER(delta, i, 0u, pc_quad(pc_zero3(), PC_REAL(0.0)));
  PC_SCATTER(delta, i, 1u, pc_quad(pc_zero3(), PC_REAL(0.0)));
}
