// The rows of a joint while it is solved: a pin (three rows as one 3 x 3 block) and up to three angle rows.
const uint JOINT_ARM_A = 0u;  // from each centre of mass to the pin, this sub-step
const uint JOINT_ARM_B = 3u;
const uint JOINT_GAP = 6u;      // pin of b minus pin of a
const uint JOINT_K = 9u;        // inverse of the pin block: xx xy xz yy yz zz
const uint JOINT_AXIS = 15u;    // three axes: the slack of row i grows with axis_i . (w_b - w_a)
const uint JOINT_SLACK = 24u;   // how far each row is inside its limit [rad]
const uint JOINT_MASS = 27u;    // effective masses; 0 where there is no row
const uint JOINT_SIGN = 30u;    // +1 at a lower limit, -1 at an upper one; axes are already turned by it
const uint JOINT_LOCKED = 33u;  // 1 where lower = upper: the row pulls both ways
const uint JOINT_GIVE = 36u;    // of rows inside trees: compliance of the pin
// and what answers a couple on b, its opposite on a: relative angular velocity, xx xy xz yy yz zz
const uint JOINT_TURN = 37u;
const uint JOINT_MOVE = 43u;    // and velocity of the pin, three rows
const uint JOINT_NEAR_A = 52u;  // arms from the places of now to a common point
const uint JOINT_NEAR_B = 55u;
const uint JOINT_MOST = 58u;  // largest impulse of the pin; 0: any
// motor and spring (joint_drive_rows.inl), where some joint has any
const uint JOINT_DRIVE = 60u;       // 0 none, 1 of the joint, 2 a spring between two points
const uint JOINT_DRIVE_AXIS = 61u;  // of a's joint frame; or the first along the line
const uint JOINT_DRIVE_AWAY = 70u;  // from rest along them
const uint JOINT_DRIVE_LAST = 73u;  // velocities along them, of the last sub-step
const uint JOINT_DRIVE_KICK = 76u;  // time over which it acts
const uint JOINT_DRIVE_STIFFNESS = 77u;
const uint JOINT_DRIVE_DAMPING = 78u;
const uint JOINT_MOTOR_SPEED = 79u;
// its largest impulse; of a spring between points what it gives beyond stopping its ends, 0: any
const uint JOINT_MOTOR_MOST = 80u;
const uint JOINT_DRIVE_GAMMA = 81u;  // impulse -(push + gamma u')
const uint JOINT_DRIVE_PUSH = 84u;
const uint JOINT_DRIVE_ANSWER = 87u;  // velocity per impulse
const uint JOINT_DRIVE_TOTAL = 90u;   // impulses in this sub-step
const uint JOINT_MOTOR_TOTAL = 93u;

PC_FN Vec3 pc_ld3_joint(PC_IO Slot m, uint f) {
  return Vec3(PC_LD(joint_rows, m, f), PC_LD(joint_rows, m, f + 1u), PC_LD(joint_rows, m, f + 2u));
}

PC_FN Sym3 pc_lds_joint(PC_IO Slot m, uint f) {
  return pc_sym3(PC_LD(joint_rows, m, f), PC_LD(joint_rows, m, f + 1u), PC_LD(joint_rows, m, f + 2u),
                 PC_LD(joint_rows, m, f + 3u), PC_LD(joint_rows, m, f + 4u), PC_LD(joint_rows, m, f + 5u));
}
// What a pin of so much impulse changes it by, where it would change it by so much.
PC_FN Vec3 pc_within_most(PC_IO Slot m, Vec3 before, Vec3 change) {
  Real most = PC_LD(joint_rows, m, JOINT_MOST);
  Vec3 whole = pc_add(before, change);
  Real size = pc_length(whole);
  Vec3 held = pc_scale(whole, pc_div(most, pc_max(pc_max(size, most), PC_TINY)));
  return pc_select3(pc_and(most > PC_REAL(0.0), size > most), pc_sub(held, before), change);
}
// Both arms, drawn to one common point where the bodies have moved, or the pin's impulses would exert a couple
// (not where they fly apart further than about a sixth of the arms: the block is of the frozen ones).
struct PinArms {
  Vec3 a;
  Vec3 b;
};
PC_FN PinArms pc_common_arms(Vec3 frozen_a, Vec3 frozen_b, Vec3 apart) {
  Vec3 moved_all = pc_sub(apart, pc_sub(frozen_a, frozen_b));
  precise Real reach = pc_dot(frozen_a, frozen_a) + pc_dot(frozen_b, frozen_b);
  precise Real way = pc_four_times(pc_four_times(pc_dot(moved_all, moved_all))) * PC_REAL(2.0);
  Vec3 moved = pc_select3(way < reach, moved_all, pc_zero3());
  PinArms arms;
  arms.a = pc_madd(frozen_a, moved, PC_REAL(0.5));
  arms.b = pc_madd(frozen_b, moved, PC_REAL(-0.5));
  return arms;
}
// What lasts of the angle rows, as a couple.
PC_FN Vec3 pc_row_couple(PC_IO Slot m, uint row, Real remembered) {
  precise Real impulse = remembered * PC_LD(joint_rows, m, JOINT_SIGN + row);
  return pc_scale(pc_ld3_joint(PC_PASS m, JOINT_AXIS + row * 3u), impulse);
}
PC_FN Vec3 pc_lasting_couple(PC_IO Slot m, Quad angle) {
  Vec3 c0 = pc_row_couple(PC_PASS m, 0u, angle.v.x);
  Vec3 c1 = pc_row_couple(PC_PASS m, 1u, angle.v.y);
  Vec3 c2 = pc_row_couple(PC_PASS m, 2u, angle.v.z);
  precise Vec3 couple = c0 + c1 + c2;
  return couple;
}
