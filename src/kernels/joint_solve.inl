// Visits a joint: the angle rows one after the other, then the pin block (the original's order), as soft
// constraints with accumulated impulses. The relax pass is this same text with joint_rate 0, mass scale 1,
// impulse scale 0.
#include "body_state.inl"
#include "joint_rows.inl"
#include "angle_rows.inl"

// New accumulated impulse of one angle row with relative velocity u of its slack.
PC_FN Real pc_limit_row(PC_IO Real u, Real slack, Real mass, Real locked, Real impulse) {
  Mask holds = locked > PC_REAL(0.5);
  Mask open = pc_and(slack > PC_REAL(0.0), locked < PC_REAL(0.5));
  Real bias = pc_angle_bias(PC_PASS slack, open);
  Real mass_scale = pc_select(open, PC_REAL(1.0), PC_INFO(joint_mass_scale));
  Real impulse_scale = pc_select(open, PC_REAL(0.0), PC_INFO(joint_impulse_scale));
  precise Real next = impulse - mass * mass_scale * (u + bias) - impulse_scale * impulse;
  return pc_snap(pc_select(holds, next, pc_max(next, PC_REAL(0.0))));
}

struct AngleStep { Real impulse; Vec3 couple; Vec3 w; };
PC_FN AngleStep pc_angle_step(PC_IO Slot m, uint row, Vec3 w, Real remembered, Sym3 both) {
  Vec3 axis = pc_ld3_joint(PC_PASS m, JOINT_AXIS + row * 3u);
  Real mass = PC_LD(joint_rows, m, JOINT_MASS + row); Real sign = PC_LD(joint_rows, m, JOINT_SIGN + row); Real locked = PC_LD(joint_rows, m, JOINT_LOCKED + row);
  precise Real before = remembered * sign;
  Mask exists = mass > PC_REAL(0.0);
  Real next = pc_select(exists, pc_limit_row(PC_PASS pc_dot(axis, w), PC_LD(joint_rows, m, JOINT_SLACK + row), mass, locked, before), PC_REAL(0.0));
  precise Real change = next - before; precise Real result = next * sign;
  AngleStep s; s.impulse = result; s.couple = pc_scale(axis, change); s.w = pc_add(w, pc_sym_mul(both, s.couple)); return s;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(joint_ends, m, 0u); Index ib = PC_ENDS(joint_ends, m, 1u); Index joint = PC_ORDER(joint_order, m);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Quad place_a = PC_GATHER(pose, ia, 0u); Quad low_a = PC_GATHER(pose, ia, 2u); Quad place_b = PC_GATHER(pose, ib, 0u); Quad low_b = PC_GATHER(pose, ib, 2u);
  Quad pin = PC_GATHER(joint_impulse, joint, 0u); Quad angle = PC_GATHER(joint_impulse, joint, 1u);

  // angles
  Sym3 both; Sym3 ja = a.inertia; Sym3 jb = b.inertia;
  precise Real xx = ja.xx * a.response + jb.xx * b.response; precise Real xy = ja.xy * a.response + jb.xy * b.response; precise Real xz = ja.xz * a.response + jb.xz * b.response;
  precise Real yy = ja.yy * a.response + jb.yy * b.response; precise Real yz = ja.yz * a.response + jb.yz * b.response; precise Real zz = ja.zz * a.response + jb.zz * b.response;
  both.xx = xx; both.xy = xy; both.xz = xz; both.yy = yy; both.yz = yz; both.zz = zz;
  Vec3 wa = pc_angular_velocity(a); Vec3 wb = pc_angular_velocity(b);
  AngleStep s0 = pc_angle_step(PC_PASS m, 0u, pc_sub(wb, wa), angle.v.x, both);
  AngleStep s1 = pc_angle_step(PC_PASS m, 1u, s0.w, angle.v.y, both);
  AngleStep s2 = pc_angle_step(PC_PASS m, 2u, s1.w, angle.v.z, both);
  precise Vec3 couple = s0.couple + s1.couple + s2.couple;
  angle.v = Vec3(s0.impulse, s1.impulse, s2.impulse);

  // pin, with the angles' couple already acting
  precise Real minus_response = -a.response;
  Vec3 la = pc_madd(a.l, couple, minus_response); Vec3 lb = pc_madd(b.l, couple, b.response);
  Vec3 gap = pc_ld3_joint(PC_PASS m, JOINT_GAP); Vec3 frozen_a = pc_ld3_joint(PC_PASS m, JOINT_ARM_A); Vec3 frozen_b = pc_ld3_joint(PC_PASS m, JOINT_ARM_B);
  // in the relax pass the bodies have moved: both arms are drawn to one common point, or the pin's impulses would exert a couple
  Vec3 apart = pc_add(pc_sub(place_b.v, place_a.v), pc_sub(low_b.v, low_a.v));
  // (not where they fly apart further than about a sixth of the arms: the block is of the frozen ones)
  Vec3 moved_all = pc_sub(apart, pc_sub(frozen_a, frozen_b));
  precise Real reach = pc_dot(frozen_a, frozen_a) + pc_dot(frozen_b, frozen_b); precise Real way = pc_dot(moved_all, moved_all) * PC_REAL(32.0);
  Vec3 moved = pc_select3(way < reach, moved_all, pc_zero3()); Vec3 arm_a = pc_madd(frozen_a, moved, PC_REAL(0.5)); Vec3 arm_b = pc_madd(frozen_b, moved, PC_REAL(-0.5));
  Vec3 va = pc_add(a.v, pc_cross(pc_sym_mul(ja, la), arm_a)); Vec3 vb = pc_add(b.v, pc_cross(pc_sym_mul(jb, lb), arm_b));
  precise Vec3 wanted = (vb - va) + gap * PC_INFO(joint_rate);
  Sym3 k; k.xx = PC_LD(joint_rows, m, JOINT_K); k.xy = PC_LD(joint_rows, m, JOINT_K + 1u); k.xz = PC_LD(joint_rows, m, JOINT_K + 2u);
  k.yy = PC_LD(joint_rows, m, JOINT_K + 3u); k.yz = PC_LD(joint_rows, m, JOINT_K + 4u); k.zz = PC_LD(joint_rows, m, JOINT_K + 5u);
  Vec3 answer = pc_sym_mul(k, wanted);
  precise Real minus_scale = -PC_INFO(joint_mass_scale);
  precise Vec3 change = answer * minus_scale - pin.v * PC_INFO(joint_impulse_scale);
  pin.v = pc_snap3(pc_add(pin.v, change));
  PC_SCATTER(joint_impulse, joint, 0u, pin); PC_SCATTER(joint_impulse, joint, 1u, angle);
  pc_joint_apply(PC_PASS ia, ib, a, b, arm_a, arm_b, change, couple);
}
