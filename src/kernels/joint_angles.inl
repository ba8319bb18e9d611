// Angles between the two frames of a joint (section 9.4 of the original): R = axes_a* axes_b is split into a swing and
// a roll about x, R = swing * roll:
//   roll = 2 atan(R_x / R_w); swing = 2 atan(|S_yz| / S_w) (S_y, S_z) / |S_yz| = (pitch, yaw).
// A cone limits the angle between the two x axes. Each angle grows at the rate of its axis times
// the relative angular velocity.
#include "roll_axis.inl"
// Half of 154 degrees has this cosine.
#define PC_LEAST_HALF_COSINE PC_REAL(0.2236)
// (1 - s cot s) / s^2 of a swing s, a third where it is small; from sine and cosine of its half.
PC_FN Real pc_lean(Real swing, Real sine, Real cosine) {
  precise Real whole_sine = sine * pc_max(cosine, PC_LEAST_HALF_COSINE) * PC_REAL(2.0);
  precise Real whole_cosine = cosine * cosine - sine * sine;
  precise Real with_cosine = swing * whole_cosine;
  precise Real lacks = PC_REAL(1.0) - pc_div(with_cosine, pc_max(whole_sine, PC_TINY));
  precise Real squared = swing * swing;
  return pc_select(sine > PC_LITTLE, pc_div(lacks, pc_max(squared, PC_TINY)), PC_THIRD);
}
struct Angles {
  Vec3 value;
  Vec3 roll_axis;
  Vec3 second_axis;
  Vec3 third_axis;
  Vec3 x_of_a;
  Vec3 x_of_b;
};
PC_FN Angles pc_joint_angles(Quaternion fa, Quaternion fb, Mask is_cone) {
  Quaternion r0 = pc_quaternion_mul(pc_conjugate(fa), fb);
  Real flip = pc_select(r0.w < PC_REAL(0.0), PC_REAL(-1.0), PC_REAL(1.0));
  Vec3 rv = pc_scale(r0.v, flip);
  precise Real rw = r0.w * flip;
  // roll
  precise Real xw = rv.x * rv.x + rw * rw;
  Real n = pc_sqrt(xw);
  Real inverse_n = pc_inverse_or_zero(n);
  precise Real half_roll = pc_angle(pc_abs(rv.x), rw) * PC_REAL(2.0);
  Real roll = pc_select(rv.x < PC_REAL(0.0), -half_roll, half_roll);
  // swing
  precise Real tx = rv.x * inverse_n;
  precise Real tw = rw * inverse_n;
  precise Real sy = rv.y * tw - rv.z * tx;
  precise Real sz = rv.z * tw + rv.y * tx;
  precise Real ss = sy * sy + sz * sz;
  Real s = pc_sqrt(ss);
  precise Real swing = pc_angle(s, n) * PC_REAL(2.0);
  Real rate = pc_select(s > PC_SLIGHT, pc_div(swing, pc_max(s, PC_TINY)), PC_REAL(2.0));
  precise Real pitch = sy * rate;
  precise Real yaw = sz * rate;
  // axes
  Vec3 x = Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0));
  Vec3 xa = pc_rotate(fa, x);
  Vec3 xb = pc_rotate(fb, x);
  Vec3 cone_axis = pc_unit_or_zero(pc_cross(xa, xb));
  // (w = J d(pitch, yaw) + x_of_b d(roll), solved for the rates; J: how a rotation vector's rates turn the frame)
  Real lean = pc_lean(swing, s, n);
  precise Real mixed = lean * pitch * yaw;
  precise Real of_pitch = PC_REAL(1.0) - lean * yaw * yaw;
  precise Real of_yaw = PC_REAL(1.0) - lean * pitch * pitch;
  Vec3 pitch_axis = pc_rotate(fa, Vec3(-yaw, of_pitch, mixed));
  Vec3 yaw_axis = pc_rotate(fa, Vec3(pitch, mixed, of_yaw));
  Angles o;
  o.value = Vec3(roll, pc_select(is_cone, swing, pitch), pc_select(is_cone, PC_REAL(0.0), yaw));
  o.roll_axis = pc_roll_axis(xa, xb);
  o.second_axis = pc_select3(is_cone, cone_axis, pitch_axis);
  o.third_axis = pc_select3(is_cone, pc_zero3(), yaw_axis);
  o.x_of_a = xa;
  o.x_of_b = xb;
  return o;
}
