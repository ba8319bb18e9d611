// End of a step of an island with shorter sub-steps than the world's (plan/islands.h): the stored velocity goes back to
// half a sub-step of the world's behind the position, and what is read stays as it is.
#include "stagger.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad push = PC_GATHER(force, i, 0u);
  Quad turn = PC_GATHER(force, i, 1u);
  Quad linear_change = PC_GATHER(velocity_parts, i, 0u);
  Quad angular_change = PC_GATHER(velocity_parts, i, 1u);
  Quad linear_low = PC_GATHER(velocity_parts, i, 2u);
  Quad angular_low = PC_GATHER(velocity_parts, i, 3u);
  Mask dynamic_body = linear.s > PC_REAL(0.0);
  VelocityShift shift = pc_velocity_shift(PC_PASS linear, angular, linear_change, angular_change, push, turn);
  linear_change.v = pc_select3(dynamic_body, pc_snap3(pc_sub(linear_change.v, shift.u)), linear_change.v);
  angular_change.v = pc_select3(dynamic_body, pc_snap3(pc_sub(angular_change.v, shift.l)), angular_change.v);
  pc_add_shift(dynamic_body, shift.u, linear.v, linear_low.v);
  pc_add_shift(dynamic_body, shift.l, angular.v, angular_low.v);
  PC_SCATTER(motion, i, 0u, linear);
  PC_SCATTER(motion, i, 1u, angular);
  PC_SCATTER(velocity_parts, i, 0u, linear_change);
  PC_SCATTER(velocity_parts, i, 1u, angular_change);
  PC_SCATTER(velocity_parts, i, 2u, linear_low);
  PC_SCATTER(velocity_parts, i, 3u, angular_low);
}
