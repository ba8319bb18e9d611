// What the tree solve keeps of a motor and a spring of the joint to the parent, of each node as tree_rows does
// (tree_drive.inl); only where a tree has any.

// 1 where there is one, 2 where it damps and does nothing else: its axes are then the world's
const uint DRIVE_IS = 0u;
const uint DRIVE_KICK = 1u;   // time over which it acts
const uint DRIVE_FRESH = 2u;  // 1 where the body's velocity was just set
const uint MOTOR_ON = 3u;     // 0: it holds its speed; 1 and -1: it gives its torque; 2: not known yet
const uint DRIVE_SPIN = 4u;   // angular velocity before the sub-step's forces
const uint MOTOR_STIFFNESS = 7u;
const uint DRIVE_AXIS = 8u;   // of a's joint frame, turned like TREE_AXIS
const uint DRIVE_AWAY = 17u;  // rotation vector from rest along them
const uint DRIVE_LAST = 20u;  // rates along them: of the last sub-step
const uint DRIVE_STIFFNESS = 23u;
const uint DRIVE_DAMPING = 24u;
const uint MOTOR_SPEED = 25u;
const uint MOTOR_MOST = 26u;  // its largest impulse
const uint DRIVE_RATE = 27u;  // and at the prediction
const uint DRIVE_PUSH = 30u;

PC_FN Vec3 pc_ld3_drive(PC_IO Slot n, uint f) {
  return Vec3(PC_LD(tree_drive_rows, n, f), PC_LD(tree_drive_rows, n, f + 1u), PC_LD(tree_drive_rows, n, f + 2u));
}
PC_FN void pc_st3_drive(PC_IO Slot n, uint f, Vec3 v) {
  PC_ST(tree_drive_rows, n, f, v.x);
  PC_ST(tree_drive_rows, n, f + 1u, v.y);
  PC_ST(tree_drive_rows, n, f + 2u, v.z);
}
