// Stage 1 of a sub-step: forces and drag (integrate_motion.inl).
#ifdef PC_DRAG
#include "drag_share.inl"
#ifdef PC_SEED
// The original's f = 1 - F h, and 0 where that would turn a velocity round: it never grows.
PC_FN Decay pc_slowing(Real drag_times_h) {
  Decay d;
  d.loss = pc_min(drag_times_h, PC_REAL(1.0));
  precise Real left = PC_REAL(1.0) - d.loss;
  d.e = left;
  d.phi = PC_REAL(1.0);
  d.phi2 = PC_REAL(0.5);
  return d;
}
#endif
#endif
#include "body_motion.inl"
#include "integrate_motion.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  BodyMotion m;
  m.linear = PC_GATHER(motion, i, 0u);
  m.angular = PC_GATHER(motion, i, 1u);
  m.linear_low = PC_GATHER(velocity_parts, i, 2u);
  m.angular_low = PC_GATHER(velocity_parts, i, 3u);
  BodyForce f;
  f.push = PC_GATHER(force, i, 0u);
  f.turn = PC_GATHER(force, i, 1u);
#ifdef PC_DRAG
#ifdef PC_SEED
  precise Real x = f.push.s * PC_INFO(h);
  precise Real y = f.turn.s * PC_INFO(h);
  f.slow = pc_slowing(x);
  f.calm = pc_slowing(y);
#else
  f.slow = pc_decay_of(PC_GATHER(drag_terms, i, 0u));
  f.calm = pc_decay_of(PC_GATHER(drag_terms, i, 1u));
#endif
#endif
  pc_integrate(PC_PASS m, f);
  PC_SCATTER(motion, i, 0u, m.linear);
  PC_SCATTER(motion, i, 1u, m.angular);
  PC_SCATTER(velocity_parts, i, 2u, m.linear_low);
  PC_SCATTER(velocity_parts, i, 3u, m.angular_low);
}
