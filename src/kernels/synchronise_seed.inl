// End of a step of the original's scheme: the velocity that is read is (p - p_last) / h itself.
PC_FN void pc_kernel(PC_IO Index i) {
  PC_SCATTER(velocity_parts, i, 0u, pc_quad(pc_zero3(), PC_REAL(0.0)));
  PC_SCATTER(velocity_parts, i, 1u, pc_quad(pc_zero3(), PC_REAL(0.0)));
}
