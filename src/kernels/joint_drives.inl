// Before a sub-step's forces: motors and springs of joints that stand in no tree, and springs between two points, as
// rows (drive_terms.inl). What lasts of a spring's impulse is kept as that of a pin; its line goes through the midpoint
// of its ends, so the arms of a pin are right for it too.
#include "joint_rows.inl"
#include "drive_terms.inl"
#include "joint_drive_rows.inl"

struct DrivenBody {
  Quaternion q;
  Vec3 v;
  Vec3 w;
  Sym3 inertia;
  Real inverse_mass;
  Mask fresh;
};
PC_FN DrivenBody pc_driven_body(PC_IO Index i) {
  Quad turn = PC_GATHER(pose, i, 1u);
  Quad inverse = PC_GATHER(mass, i, 1u);
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  DrivenBody b;
  b.q = pc_quaternion(turn.v, turn.s);
  Sym3 inertia = pc_world_inertia(b.q, inverse.v);
  Mask moves = linear.s > PC_REAL(0.0);
  Real response = pc_select(moves, PC_REAL(1.0), PC_REAL(0.0));
  b.v = linear.v;
  b.w = pc_sym_mul(inertia, angular.v);
  b.inverse_mass = linear.s;
  b.fresh = pc_and(moves, angular.s < PC_REAL(0.0));
  b.inertia = pc_sym_scale(inertia, response);
  return b;
}
PC_FN Real pc_turned_by(Sym3 inertia, Vec3 axis) { return pc_dot(axis, pc_sym_mul(inertia, axis)); }

// A spring between two points, along the line between them.
struct SpringLine {
  Vec3 along;
  Vec3 turn_a;  // torques of a unit impulse along it
  Vec3 turn_b;
  Real longer;
  Real speed;   // of what it is longer by
  Real answer;  // velocity per impulse
};
PC_FN SpringLine pc_spring_line(DrivenBody a, DrivenBody b, Vec3 ra, Vec3 rb, Vec3 apart, Real rest_length) {
  Vec3 line = pc_add(apart, pc_sub(rb, ra));
  Real distance = pc_length(line);
  Vec3 along = pc_scale(line, pc_inverse_or_zero(distance));
  Vec3 ta = pc_cross(ra, along);
  Vec3 tb = pc_cross(rb, along);
  precise Real longer = distance - rest_length;
  precise Real speed = pc_dot(along, pc_sub(b.v, a.v)) + pc_dot(tb, b.w) - pc_dot(ta, a.w);
  precise Real answer = a.inverse_mass + b.inverse_mass + pc_turned_by(a.inertia, ta) + pc_turned_by(b.inertia, tb);
  SpringLine s;
  s.along = along;
  s.turn_a = ta;
  s.turn_b = tb;
  s.longer = longer;
  s.speed = speed;
  s.answer = answer;
  return s;
}
// It has one row, the first of three.
PC_FN Vec3 pc_first_of(Mask is_spring, Real x) {
  return Vec3(pc_select(is_spring, x, PC_REAL(0.0)), PC_REAL(0.0), PC_REAL(0.0));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(joint_ends, m, 0u);
  Index ib = PC_ENDS(joint_ends, m, 1u);
  Index joint = PC_ORDER(joint_order, m);
  Quad rest = PC_GATHER(joint_drive, joint, 0u);
  Quad drive = PC_GATHER(joint_drive, joint, 1u);
  Quad power = PC_GATHER(joint_drive, joint, 2u);
  PC_ST(joint_rows, m, JOINT_DRIVE, power.v.x);
  Quad place_a = PC_GATHER(pose, ia, 0u);
  Quad low_a = PC_GATHER(pose, ia, 2u);
  Quad place_b = PC_GATHER(pose, ib, 0u);
  Quad low_b = PC_GATHER(pose, ib, 2u);
  Quad anchor_a = PC_GATHER(joint_frame, joint, 0u);
  Quad axes_a = PC_GATHER(joint_frame, joint, 1u);
  Quad anchor_b = PC_GATHER(joint_frame, joint, 2u);
  Quad axes_b = PC_GATHER(joint_frame, joint, 3u);
  DrivenBody a = pc_driven_body(PC_PASS ia);
  DrivenBody b = pc_driven_body(PC_PASS ib);
  Vec3 spin = pc_sub(b.w, a.w);
  Real zero = PC_REAL(0.0);
  Mask is_spring = power.v.x > PC_REAL(1.0);
  Mask is_driven = pc_and(power.v.x > PC_REAL(0.5), power.v.x < PC_REAL(2.0));
  // about a's joint frame
  DriveFrame f =
      pc_drive_frame(pc_quaternion_mul(a.q, pc_quaternion(axes_a.v, axes_a.s)),
                     pc_quaternion_mul(b.q, pc_quaternion(axes_b.v, axes_b.s)), pc_quaternion(rest.v, rest.s));
  // or along the line between the points
  Vec3 apart = pc_add(pc_sub(place_b.v, place_a.v), pc_sub(low_b.v, low_a.v));
  SpringLine s = pc_spring_line(a, b, pc_rotate(a.q, anchor_a.v), pc_rotate(b.q, anchor_b.v), apart, power.v.y);
  Vec3 rates = Vec3(pc_dot(f.x, spin), pc_dot(f.y, spin), pc_dot(f.z, spin));
  Vec3 away = pc_select3(is_driven, f.away, pc_first_of(is_spring, s.longer));
  Vec3 last = pc_select3(is_driven, rates, pc_first_of(is_spring, s.speed));
  Vec3 x = pc_select3(is_spring, s.along, f.x);
  pc_st3_drive(PC_PASS m, JOINT_DRIVE_AXIS, x);
  pc_st3_drive(PC_PASS m, JOINT_DRIVE_AXIS + 3u, f.y);
  pc_st3_drive(PC_PASS m, JOINT_DRIVE_AXIS + 6u, f.z);
  pc_st3_drive(PC_PASS m, JOINT_DRIVE_AWAY, away);
  pc_st3_drive(PC_PASS m, JOINT_DRIVE_LAST, last);
  precise Real half_kick = PC_INFO(h) * PC_REAL(0.5);
  Real kick = pc_select(pc_or(a.fresh, b.fresh), half_kick, PC_INFO(h));
  precise Real motor_most = pc_select(is_driven, drive.v.y, zero) * kick;
  Real spring_most = pc_spring_most(PC_PASS pc_sym_mul(a.inertia, s.turn_a), pc_sym_mul(b.inertia, s.turn_b));
  Mask any = pc_or(is_driven, is_spring);
  PC_ST(joint_rows, m, JOINT_DRIVE_KICK, kick);
  PC_ST(joint_rows, m, JOINT_DRIVE_STIFFNESS, pc_select(any, drive.v.z, zero));
  PC_ST(joint_rows, m, JOINT_DRIVE_DAMPING, pc_select(any, drive.s, zero));
  PC_ST(joint_rows, m, JOINT_MOTOR_SPEED, drive.v.x);
  PC_ST(joint_rows, m, JOINT_MOTOR_MOST, pc_select(is_spring, spring_most, motor_most));
  PC_ST(joint_rows, m, JOINT_MOTOR_TOTAL, zero);
  pc_st3_drive(PC_PASS m, JOINT_DRIVE_TOTAL, pc_zero3());
  Sym3 both = pc_sym_add(a.inertia, b.inertia);
  pc_drive_coefficients(PC_PASS m, Vec3(pc_select(is_spring, s.answer, pc_turned_by(both, f.x)),
                                        pc_turned_by(both, f.y), pc_turned_by(both, f.z)));
}
