// Impulse F at the pin and couple M act on b, their opposites on a.
PC_FN void pc_joint_apply(PC_IO Index ia, Index ib, BodyState a, BodyState b, Vec3 arm_a, Vec3 arm_b, Vec3 impulse,
                          Vec3 couple) {
  Vec3 torque_a = pc_moment(couple, arm_a, impulse);
  Vec3 torque_b = pc_moment(couple, arm_b, impulse);
  precise Real minus_mass = -a.inverse_mass;
  precise Real minus_response = -a.response;
  Vec3 va = pc_madd(a.v, impulse, minus_mass);
  Vec3 vb = pc_madd(b.v, impulse, b.inverse_mass);
  Vec3 la = pc_madd(a.l, torque_a, minus_response);
  Vec3 lb = pc_madd(b.l, torque_b, b.response);
  PC_SCATTER_IF(a.inverse_mass > PC_REAL(0.0), motion, ia, 0u, pc_quad(va, a.inverse_mass));
  PC_SCATTER_IF(a.inverse_mass > PC_REAL(0.0), motion, ia, 1u, pc_quad(la, a.phase));
  PC_SCATTER_IF(b.inverse_mass > PC_REAL(0.0), motion, ib, 0u, pc_quad(vb, b.inverse_mass));
  PC_SCATTER_IF(b.inverse_mass > PC_REAL(0.0), motion, ib, 1u, pc_quad(lb, b.phase));
}
