// Writes a body's inverse inertia in world axes, and whether impulses act on it.
PC_FN void pc_store_inertia(PC_IO Index i, Real inverse_mass) {
  Quad orientation = PC_GATHER(pose, i, 1u);
  Quad inverse = PC_GATHER(mass, i, 1u);
  Sym3 w = pc_world_inertia(pc_quaternion(orientation.v, orientation.s), inverse.v);
  Real response = pc_select(inverse_mass > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  PC_SCATTER(inertia, i, 0u, pc_quad(Vec3(w.xx, w.xy, w.xz), w.yy));
  Real most = pc_max(inverse.v.x, pc_max(inverse.v.y, inverse.v.z)); Real least = pc_min(inverse.v.x, pc_min(inverse.v.y, inverse.v.z));
  precise Real range = most - least; precise Real unlike = range * pc_inverse_or_zero(least) * response;
  PC_SCATTER(inertia, i, 1u, pc_quad(Vec3(w.yz, w.zz, response), unlike));
}
