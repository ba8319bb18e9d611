// Visits of a joint's angle rows, as soft constraints with accumulated impulses. Needs joint_rows.inl.
#include "angle_rows.inl"

// New accumulated impulse of one angle row with relative velocity u of its slack.
PC_FN Real pc_limit_row(PC_IO Real u, Real slack, Real mass, Real locked, Real impulse) {
  Mask holds = locked > PC_REAL(0.5);
  Mask open = pc_and(slack > PC_REAL(0.0), locked < PC_REAL(0.5));
  Real bias = pc_angle_bias(PC_PASS slack, open);
  Real mass_scale = pc_select(open, PC_REAL(1.0), PC_INFO(soft_mass_scale));
  Real impulse_scale = pc_select(open, PC_REAL(0.0), PC_INFO(soft_impulse_scale));
  precise Real next = impulse - mass * mass_scale * (u + bias) - impulse_scale * impulse;
  return pc_snap(pc_select(holds, next, pc_max(next, PC_REAL(0.0))));
}

struct AngleStep {
  Real impulse;
  Vec3 couple;
  Vec3 w;
};
PC_FN AngleStep pc_angle_step(PC_IO Slot m, uint row, Vec3 w, Real remembered, Sym3 both) {
  Vec3 axis = pc_ld3_joint(PC_PASS m, JOINT_AXIS + row * 3u);
  Real mass = PC_LD(joint_rows, m, JOINT_MASS + row);
  Real sign = PC_LD(joint_rows, m, JOINT_SIGN + row);
  Real locked = PC_LD(joint_rows, m, JOINT_LOCKED + row);
  precise Real before = remembered * sign;
  Mask exists = mass > PC_REAL(0.0);
  Real next = pc_select(
      exists, pc_limit_row(PC_PASS pc_dot(axis, w), PC_LD(joint_rows, m, JOINT_SLACK + row), mass, locked, before),
      PC_REAL(0.0));
  precise Real change = next - before;
  precise Real result = next * sign;
  AngleStep s;
  s.impulse = result;
  s.couple = pc_scale(axis, change);
  s.w = pc_add(w, pc_sym_mul(both, s.couple));
  return s;
}
// All three, one after the other, from relative angular velocity w; impulses in `angle`.
// `both`: how w answers a couple.
PC_FN Vec3 pc_angle_steps(PC_IO Slot m, Vec3 w, Sym3 both, PC_INOUT(Quad) angle) {
  AngleStep s0 = pc_angle_step(PC_PASS m, 0u, w, angle.v.x, both);
  AngleStep s1 = pc_angle_step(PC_PASS m, 1u, s0.w, angle.v.y, both);
  AngleStep s2 = pc_angle_step(PC_PASS m, 2u, s1.w, angle.v.z, both);
  precise Vec3 couple = s0.couple + s1.couple + s2.couple;
  angle.v = Vec3(s0.impulse, s1.impulse, s2.impulse);
  return couple;
}
