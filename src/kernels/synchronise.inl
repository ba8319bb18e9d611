// After the last sub-step: half of what it changed in the velocities (half_changes.inl).
#ifdef PC_DRAG
#include "drag_share.inl"
#endif
#include "body_motion.inl"
#include "half_changes.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad linear_before = PC_GATHER(velocity_parts, i, 0u);
  Quad angular_before = PC_GATHER(velocity_parts, i, 1u);
  BodyForce f;
  f.push = PC_GATHER(force, i, 0u);
  f.turn = PC_GATHER(force, i, 1u);
#ifdef PC_DRAG
  f.slow = pc_decay_of(PC_GATHER(drag_terms, i, 0u));
  f.calm = pc_decay_of(PC_GATHER(drag_terms, i, 1u));
#endif
  HalfChanges c = pc_half_changes(PC_PASS linear, angular, linear_before, angular_before, PC_GATHER(mass, i, 0u), f);
  PC_SCATTER(velocity_parts, i, 0u, pc_quad(c.u, PC_REAL(0.0)));
  PC_SCATTER(velocity_parts, i, 1u, pc_quad(c.l, PC_REAL(0.0)));
}
