// A blow is no force: the velocity that is read, which lacks half of what the forces of a sub-step changed, has it
// whole (synchronise).
PC_FN void pc_count_blow(PC_IO Index i, Mask these, Vec3 dv, Vec3 dl) {
  Quad linear = PC_GATHER(velocity_parts, i, 0u);
  Quad angular = PC_GATHER(velocity_parts, i, 1u);
  PC_SCATTER_IF(these, velocity_parts, i, 0u, pc_quad(pc_add(linear.v, dv), linear.s));
  PC_SCATTER_IF(these, velocity_parts, i, 1u, pc_quad(pc_add(angular.v, dl), angular.s));
}
