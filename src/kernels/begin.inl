// Start of a step. The stored velocity u is half a sub-step behind the position (stagger.inl).
#ifdef PC_DRAG
#include "drag_share.inl"
#endif
#include "stagger.inl"
#include "body_motion.inl"
#include "begin_motion.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  BodyMotion m;
  m.linear = PC_GATHER(motion, i, 0u);
  m.angular = PC_GATHER(motion, i, 1u);
#ifndef PC_SEED
  BodyForce f;
  f.push = PC_GATHER(force, i, 0u);
  f.turn = PC_GATHER(force, i, 1u);
#endif
  Quad linear_change = PC_GATHER(velocity_parts, i, 0u);
  Quad angular_change = PC_GATHER(velocity_parts, i, 1u);
  m.linear_low = PC_GATHER(velocity_parts, i, 2u);
  m.angular_low = PC_GATHER(velocity_parts, i, 3u);

#ifdef PC_SEED
  Mask in_phase = pc_in_phase(m.linear, m.angular);
  VelocityShift shift;
  shift.u = pc_shift(PC_PASS in_phase, m.linear.v, linear_change.v);
  shift.l = pc_shift(PC_PASS in_phase, m.angular.v, angular_change.v);
#else
  VelocityShift shift = pc_velocity_shift(PC_PASS m.linear, m.angular, linear_change, angular_change, f.push, f.turn);
#endif
  pc_begin(m, shift);
  PC_SCATTER(motion, i, 0u, m.linear);
  PC_SCATTER(motion, i, 1u, m.angular);
  PC_SCATTER(velocity_parts, i, 2u, m.linear_low);
  PC_SCATTER(velocity_parts, i, 3u, m.angular_low);

#ifdef PC_DRAG
  pc_find_decays(PC_PASS f);
  PC_SCATTER(drag_terms, i, 0u, pc_terms_of(f.slow));
  PC_SCATTER(drag_terms, i, 1u, pc_terms_of(f.calm));
#endif
  PC_SCATTER(delta, i, 0u, pc_quad(pc_zero3(), PC_REAL(0.0)));
  PC_SCATTER(delta, i, 1u, pc_quad(pc_zero3(), PC_REAL(0.0)));
  PC_SCATTER(delta, i, 2u, pc_quad(pc_zero3(), PC_REAL(0.0)));
}
