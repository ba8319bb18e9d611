// The rows of a joint while it is solved: a pin (three rows as one 3 x 3 block) and up to three angle rows.
const uint JOINT_ARM_A = 0u;    // from each centre of mass to the pin, this sub-step
const uint JOINT_ARM_B = 3u;
const uint JOINT_GAP = 6u;      // pin of b minus pin of a
const uint JOINT_K = 9u;        // inverse of the pin block: xx xy xz yy yz zz
const uint JOINT_AXIS = 15u;    // three axes: the slack of row i grows with axis_i . (w_b - w_a)
const uint JOINT_SLACK = 24u;   // how far each row is inside its limit [rad]
const uint JOINT_MASS = 27u;    // effective masses; 0 where there is no row
const uint JOINT_SIGN = 30u;    // +1 at a lower limit, -1 at an upper one; axes are already turned by it
const uint JOINT_LOCKED = 33u;  // 1 where lower = upper: the row pulls both ways

PC_FN Vec3 pc_ld3_joint(PC_IO Slot m, uint f) { return Vec3(PC_LD(joint_rows, m, f), PC_LD(joint_rows, m, f + 1u), PC_LD(joint_rows, m, f + 2u)); }

// Impulse F at the pin and couple M act on b, their opposites on a.
PC_FN void pc_joint_apply(PC_IO Index ia, Index ib, BodyState a, BodyState b, Vec3 arm_a, Vec3 arm_b, Vec3 impulse, Vec3 couple) {
  Vec3 torque_a = pc_add(couple, pc_cross(arm_a, impulse)); Vec3 torque_b = pc_add(couple, pc_cross(arm_b, impulse));
  precise Real minus_mass = -a.inverse_mass; precise Real minus_response = -a.response;
  Vec3 va = pc_madd(a.v, impulse, minus_mass); Vec3 vb = pc_madd(b.v, impulse, b.inverse_mass);
  Vec3 la = pc_madd(a.l, torque_a, minus_response); Vec3 lb = pc_madd(b.l, torque_b, b.response);
  PC_SCATTER_IF(a.inverse_mass > PC_REAL(0.0), motion, ia, 0u, pc_quad(va, a.inverse_mass));
  PC_SCATTER_IF(a.inverse_mass > PC_REAL(0.0), motion, ia, 1u, pc_quad(la, a.phase));
  PC_SCATTER_IF(b.inverse_mass > PC_REAL(0.0), motion, ib, 0u, pc_quad(vb, b.inverse_mass));
  PC_SCATTER_IF(b.inverse_mass > PC_REAL(0.0), motion, ib, 1u, pc_quad(lb, b.phase));
}
