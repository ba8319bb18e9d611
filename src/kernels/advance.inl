// End of a sub-step: the pose moves with the velocities (advance_pose.inl).
#include "body_motion.inl"
#include "advance_pose.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad inverse = PC_GATHER(mass, i, 1u);
  BodyPose p;
  p.place = PC_GATHER(pose, i, 0u);
  p.turned = PC_GATHER(pose, i, 1u);
  p.place_low = PC_GATHER(pose, i, 2u);
  p.turned_low = PC_GATHER(pose, i, 3u);
  Quad moved = PC_GATHER(delta, i, 0u);
  Quad rotated = PC_GATHER(delta, i, 1u);

  Moved m = pc_advance(PC_PASS p, linear, angular, inverse);
#ifdef PC_SEED
  PC_SCATTER(motion, i, 1u, angular);
#endif

  // the rotation itself: (q + change) q* = 1 + change q*
  Quaternion rotation = pc_quaternion_mul(m.change, pc_conjugate(m.before));
  Real two = pc_select(rotation.w < PC_REAL(-1.0), PC_REAL(-2.0), PC_REAL(2.0));
  moved.v = pc_add(moved.v, m.step);
  rotated.v = pc_madd(rotated.v, rotation.v, two);
  precise Real turned_square = moved.s + pc_four_times(pc_dot(rotation.v, rotation.v));
  moved.s = turned_square;

  PC_SCATTER(pose, i, 0u, p.place);
  PC_SCATTER(pose, i, 1u, p.turned);
  PC_SCATTER(pose, i, 2u, p.place_low);
  PC_SCATTER(pose, i, 3u, p.turned_low);
  PC_SCATTER(delta, i, 0u, moved);
  PC_SCATTER(delta, i, 2u, pc_quad(pc_zero3(), PC_REAL(0.0)));
  PC_SCATTER(delta, i, 1u, pc_quad(rotated.v, rotated.s));
}
