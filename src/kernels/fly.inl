// All sub-steps of a body that nothing meets and nothing holds, in one pass over its rows: begin, then integrate and
// advance in each sub-step, then synchronise, with the bits of those kernels one after the other (tests/flight.cpp). A
// body that would leave the range of numbers (constants::largest_state) is not moved: its phase says that it is to be
// frozen, and a flag tells the host to look. Nothing acts on another here, so all others have made their step.
#ifdef PC_DRAG
#include "drag_share.inl"
#endif
#include "stagger.inl"
#include "body_motion.inl"
#include "begin_motion.inl"
#include "integrate_motion.inl"
#include "advance_pose.inl"
#include "half_changes.inl"

PC_FN Real pc_size(Vec3 a) {
  precise Real s = pc_abs(a.x) + pc_abs(a.y) + pc_abs(a.z);
  return s;
}
// As world/range.cpp; what is no number is not below anything.
PC_FN Mask pc_inside(PC_IO BodyMotion m, BodyPose p, Vec3 inverse) {
  Real limit = PC_INFO(largest_state);
#ifdef PC_STILL
  Mask place = pc_size(p.place.v) < limit;
#else
  precise Real turned = pc_size(p.turned.v) + pc_abs(p.turned.s);
  Mask place = pc_and(pc_size(p.place.v) < limit, turned < pc_four_times(PC_REAL(1.0)));
#endif
  precise Real spin = pc_size(m.angular.v) * pc_max(inverse.x, pc_max(inverse.y, inverse.z));
  return pc_and(place, pc_and(pc_size(m.linear.v) < limit, spin < limit));
}

PC_FN void pc_kernel(PC_IO Index i) {
  BodyMotion m;
  m.linear = PC_GATHER(motion, i, 0u);
  m.angular = PC_GATHER(motion, i, 1u);
  m.linear_low = PC_GATHER(velocity_parts, i, 2u);
  m.angular_low = PC_GATHER(velocity_parts, i, 3u);
  BodyForce f;
  f.push = PC_GATHER(force, i, 0u);
  f.turn = PC_GATHER(force, i, 1u);
  Quad linear_before = PC_GATHER(velocity_parts, i, 0u);
  Quad angular_before = PC_GATHER(velocity_parts, i, 1u);
  BodyPose p;
  p.place = PC_GATHER(pose, i, 0u);
  p.place_low = PC_GATHER(pose, i, 2u);
#ifndef PC_STILL
  p.turned = PC_GATHER(pose, i, 1u);
  p.turned_low = PC_GATHER(pose, i, 3u);
#endif
  Quad inverse = PC_GATHER(mass, i, 1u);

  pc_begin(m, pc_velocity_shift(PC_PASS m.linear, m.angular, linear_before, angular_before, f.push, f.turn));
#ifdef PC_DRAG
  pc_find_decays(PC_PASS f);
#endif
  for (uint k = 0u; k < PC_COUNT(substeps); k++) {
    linear_before = m.linear;
    angular_before = m.angular;
    pc_integrate(PC_PASS m, f);
#ifdef PC_STILL
    pc_move(PC_PASS p, m.linear);
#else
    pc_advance(PC_PASS p, m.linear, m.angular, inverse);
#endif
  }
  HalfChanges c =
      pc_half_changes(PC_PASS m.linear, m.angular, linear_before, angular_before, PC_GATHER(mass, i, 0u), f);

  Mask inside = pc_inside(PC_PASS m, p, inverse.v);
  Mask moves = pc_and(inside, pc_some(i));  // row 0 pads
  Mask leaves = pc_select(inside, PC_REAL(0.0), PC_REAL(1.0)) > PC_REAL(0.5);
  PC_SCATTER_IF(leaves, motion, i, 1u, pc_quad(PC_GATHER(motion, i, 1u).v, PC_REAL(-2.0)));
  PC_RAISE(leaves, velocity_parts, 1u);
  PC_SCATTER_IF(moves, motion, i, 0u, m.linear);
  PC_SCATTER_IF(moves, motion, i, 1u, m.angular);
  PC_SCATTER_IF(moves, pose, i, 0u, p.place);
  PC_SCATTER_IF(moves, pose, i, 2u, p.place_low);
#ifndef PC_STILL
  PC_SCATTER_IF(moves, pose, i, 1u, p.turned);
  PC_SCATTER_IF(moves, pose, i, 3u, p.turned_low);
#endif
  PC_SCATTER_IF(moves, velocity_parts, i, 0u, pc_quad(c.u, PC_REAL(0.0)));
  PC_SCATTER_IF(moves, velocity_parts, i, 1u, pc_quad(c.l, PC_REAL(0.0)));
  PC_SCATTER_IF(moves, velocity_parts, i, 2u, m.linear_low);
  PC_SCATTER_IF(moves, velocity_parts, i, 3u, m.angular_low);
}
