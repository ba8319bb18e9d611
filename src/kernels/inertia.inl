// A body's inverse inertia in world axes, and whether impulses act on it: for contacts and joints, of each sub-step.
PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad orientation = PC_GATHER(pose, i, 1u);
  Quad inverse = PC_GATHER(mass, i, 1u);
  Sym3 w = pc_world_inertia(pc_quaternion(orientation.v, orientation.s), inverse.v);
  PC_SCATTER(inertia, i, 0u, pc_quad(Vec3(w.xx, w.xy, w.xz), w.yy));
  Real most = pc_max(inverse.v.x, pc_max(inverse.v.y, inverse.v.z));
  Real least = pc_min(inverse.v.x, pc_min(inverse.v.y, inverse.v.z));
  Real response = pc_select(pc_min(linear.s, most) > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  precise Real range = most - least;
  precise Real unlike = range * pc_inverse_or_zero(least) * response;
  PC_SCATTER(inertia, i, 1u, pc_quad(Vec3(w.yz, w.zz, response), unlike));
}
