// After the last sub-step: half of what it changed in the velocities, so that u + half change is the
// velocity in phase with the position, to second order. A body that a contact touched keeps u itself:
// at rest that is zero, and an impact is no acceleration.
PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad linear_before = PC_GATHER(half_change, i, 0u);
  Quad angular_before = PC_GATHER(half_change, i, 1u);
  Real share = pc_select(angular.s > PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.5));
  precise Vec3 u = (linear.v - linear_before.v) * share;
  precise Vec3 l = (angular.v - angular_before.v) * share;
  PC_SCATTER(half_change, i, 0u, pc_quad(pc_snap3(u), PC_REAL(0.0)));
  PC_SCATTER(half_change, i, 1u, pc_quad(pc_snap3(l), PC_REAL(0.0)));
}
