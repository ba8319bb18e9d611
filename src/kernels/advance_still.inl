// The end of a sub-step where no body rotates.
#define PC_STILL
#include "body_motion.inl"
#include "advance_pose.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad moved = PC_GATHER(delta, i, 0u);
  BodyPose p;
  p.place = PC_GATHER(pose, i, 0u);
  p.place_low = PC_GATHER(pose, i, 2u);
  moved.v = pc_add(moved.v, pc_move(PC_PASS p, linear));
  PC_SCATTER(pose, i, 0u, p.place);
  PC_SCATTER(pose, i, 2u, p.place_low);
  PC_SCATTER(delta, i, 0u, moved);
  PC_SCATTER(delta, i, 2u, pc_quad(pc_zero3(), PC_REAL(0.0)));
}
#undef PC_STILL
