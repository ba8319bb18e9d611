// Before the last sub-step: keeps the velocities, from which `synchronise` takes the half change.
PC_FN void pc_kernel(PC_IO Index i) {
  PC_SCATTER(velocity_parts, i, 0u, PC_GATHER(motion, i, 0u));
  PC_SCATTER(velocity_parts, i, 1u, PC_GATHER(motion, i, 1u));
}
