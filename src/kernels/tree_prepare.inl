// Start of a sub-step's trees: arms, gaps, inertia, angle rows at the present pose.
//
// Geometric stiffness: a pin's impulse F turns with the body, so while the body turns by h dw the torque changes by
// (h dw x r) x F. Half of that, from the last sub-step's F, stands in the inertia: I + h / 2 sum of (r . F) 1 - r F^T
// (symmetric part, shifted to be positive). Without it stiff chains under heavy loads diverge (docs/joints.md).
#include "joint_angles.inl"
#include "tree_rows.inl"
#include "tree_store.inl"

PC_FN Sym3 pc_geometric(Sym3 k, Vec3 r, Vec3 f) {
  Real d = pc_dot(r, f); Real s = PC_REAL(-0.5);
  precise Real xx = k.xx + (d - r.x * f.x); precise Real yy = k.yy + (d - r.y * f.y); precise Real zz = k.zz + (d - r.z * f.z);
  precise Real xy = k.xy + (r.x * f.y + r.y * f.x) * s; precise Real xz = k.xz + (r.x * f.z + r.z * f.x) * s; precise Real yz = k.yz + (r.y * f.z + r.z * f.y) * s;
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
// Of a body's inertia I and the stiffness k of its pins: x = h^2 k / 4 I (k is an impulse: of the sub-step) is the limit
// of stability at 1. `fast` = x / (1 + x); the inertia gets fast h / 2 (k - low 1), low at most the smallest eigenvalue
// of k (Gershgorin): a term of fourth order where the sub-step resolves the motion, stable at any x.
struct Stiffened { Sym3 inertia; Real fast; };
PC_FN Stiffened pc_stiffened(PC_IO Sym3 i, Sym3 k) {
  precise Real x = k.xx - pc_abs(k.xy) - pc_abs(k.xz); precise Real y = k.yy - pc_abs(k.xy) - pc_abs(k.yz); precise Real z = k.zz - pc_abs(k.xz) - pc_abs(k.yz);
  Real low = pc_min(PC_REAL(0.0), pc_min(x, pc_min(y, z)));
  precise Real stiff = (k.xx + k.yy + k.zz - low * PC_REAL(3.0)) * PC_INFO(h); precise Real slow = (i.xx + i.yy + i.zz) * PC_REAL(4.0); precise Real all = stiff + slow;
  precise Real fast = stiff * pc_inverse_or_zero(all); precise Real weight = PC_INFO(h) * PC_REAL(0.5) * fast;
  precise Real xx = i.xx + (k.xx - low) * weight; precise Real xy = i.xy + k.xy * weight; precise Real xz = i.xz + k.xz * weight;
  precise Real yy = i.yy + (k.yy - low) * weight; precise Real yz = i.yz + k.yz * weight; precise Real zz = i.zz + (k.zz - low) * weight;
  Stiffened r; r.inertia = pc_sym3(xx, xy, xz, yy, yz, zz); r.fast = fast; return r;
}

// One angle row at its nearer limit. It acts from the start where it did in the last sub-step; tree_solve adds others.
PC_FN void pc_tree_angle(PC_IO Slot n, uint row, Vec3 axis, Real flip, Real angle, Real lower, Real upper, Mask exists, Real remembered) {
  precise Real above = angle - lower; precise Real below = upper - angle; precise Real interval = upper - lower;
  Mask at_lower = above < below; Mask locked = pc_and(exists, interval < PC_REAL(1e-6));
  Real one = PC_REAL(1.0); Real zero = PC_REAL(0.0);
  Real sign = pc_select(pc_or(at_lower, locked), one, PC_REAL(-1.0));
  Real slack = pc_select(locked, above, pc_select(at_lower, above, below));
  precise Real turned = sign * flip; precise Real pressed = remembered * sign;
  Vec3 j = pc_select3(exists, pc_scale(axis, turned), pc_zero3());
  pc_st3_tree(PC_PASS n, TREE_AXIS + row * 3u, j);
  PC_ST(tree_rows, n, TREE_SLACK + row, slack); PC_ST(tree_rows, n, TREE_SIGN + row, sign);
  PC_ST(tree_rows, n, TREE_KIND + row, pc_select(locked, PC_REAL(2.0), pc_select(exists, one, zero)));
  PC_ST(tree_rows, n, TREE_ON + row, pc_select(locked, one, pc_select(pc_and(exists, pressed > zero), one, zero)));
}

// The three angle rows of a joint; a joint without angles has three that never act.
PC_FN void pc_tree_angles(PC_IO Slot n, uint b, Quaternion qc, Quaternion qp, Quad axes_c, Quad axes_p, Quad head, Quad lower, Quad upper, Vec3 remembered) {
  Mask any = head.s > PC_REAL(0.5); Mask is_cone = pc_and(any, head.s < PC_REAL(1.5)); Mask is_angles = head.s > PC_REAL(1.5);
  PC_ST(tree_rows, n, TREE_HAS_ROWS, pc_select(any, PC_REAL(1.0), PC_REAL(0.0)));
  if (!PC_ANY(any)) {  // lint: allow (rows of kind 0 are the same whatever their axes)
    for (uint f = TREE_AXIS; f < TREE_C; f++) PC_ST(tree_rows, n, f, PC_REAL(0.0));
    return;
  }
  Quaternion fc = pc_quaternion_mul(qc, pc_quaternion(axes_c.v, axes_c.s)); Quaternion fp = pc_quaternion_mul(qp, pc_quaternion(axes_p.v, axes_p.s));
  Mask flipped = PC_IS(b); Real flip = pc_select(flipped, PC_REAL(-1.0), PC_REAL(1.0));
  Quaternion fa; fa.v = pc_select3(flipped, fc.v, fp.v); fa.w = pc_select(flipped, fc.w, fp.w);
  Quaternion fb; fb.v = pc_select3(flipped, fp.v, fc.v); fb.w = pc_select(flipped, fp.w, fc.w);
  Angles a = pc_joint_angles(fa, fb, is_cone);
  pc_tree_angle(PC_PASS n, 0u, a.roll_axis, flip, a.value.x, lower.v.x, upper.v.x, any, remembered.x);
  pc_tree_angle(PC_PASS n, 1u, a.second_axis, flip, a.value.y, lower.v.y, upper.v.y, any, remembered.y);
  pc_tree_angle(PC_PASS n, 2u, a.third_axis, flip, a.value.z, lower.v.z, upper.v.z, is_angles, remembered.z);
}

PC_FN void pc_tree_joint(PC_IO Tree t, Slot n, uint k) {
  Slot up = PC_NODE(n, t.first + pc_parent(PC_PASS t, k)); Index child = PC_ENDS(tree_ends, n, 0u); Index parent = PC_ENDS(tree_ends, up, 0u); Index joint = PC_ENDS(tree_ends, n, 1u);
  Quad place_c = PC_GATHER(pose, child, 0u); Quad turn_c = PC_GATHER(pose, child, 1u); Quad low_c = PC_GATHER(pose, child, 2u);
  Quad place_p = PC_GATHER(pose, parent, 0u); Quad turn_p = PC_GATHER(pose, parent, 1u); Quad low_p = PC_GATHER(pose, parent, 2u);
  uint b = pc_is_flipped(PC_PASS t, k); uint c_at = (1u - b) * 2u; uint p_at = b * 2u;  // quads of joint_frame: 0 of body a, 2 of body b
  Quad anchor_c = PC_GATHER(joint_frame, joint, c_at); Quad axes_c = PC_GATHER(joint_frame, joint, c_at + 1u);
  Quad anchor_p = PC_GATHER(joint_frame, joint, p_at); Quad axes_p = PC_GATHER(joint_frame, joint, p_at + 1u);
  Quad head = PC_GATHER(joint_frame, joint, 0u); Quad lower = PC_GATHER(joint_frame, joint, 4u); Quad upper = PC_GATHER(joint_frame, joint, 5u);
  Quad pin = PC_GATHER(joint_impulse, joint, 0u); Quad angle = PC_GATHER(joint_impulse, joint, 1u);
  Quaternion qc = pc_quaternion(turn_c.v, turn_c.s); Quaternion qp = pc_quaternion(turn_p.v, turn_p.s);
  Vec3 rc = pc_rotate(qc, anchor_c.v); Vec3 rp = pc_rotate(qp, anchor_p.v);
  Vec3 apart = pc_add(pc_sub(place_c.v, place_p.v), pc_sub(low_c.v, low_p.v));
  pc_st3_tree(PC_PASS n, TREE_RC, rc); pc_st3_tree(PC_PASS n, TREE_RP, rp); pc_st3_tree(PC_PASS n, TREE_GAP, pc_add(apart, pc_sub(rc, rp)));
  pc_st3_tree(PC_PASS n, TREE_PLACE, pc_add(pc_ld3_tree(PC_PASS up, TREE_PLACE), apart));
  pc_tree_angles(PC_PASS n, b, qc, qp, axes_c, axes_p, head, lower, upper, angle.v);
  Real flip = pc_select(PC_IS(b), PC_REAL(-1.0), PC_REAL(1.0));

  // the stiffness that the last sub-step's impulse gives to both bodies
  precise Vec3 f = pin.v * flip;
  pc_sts_tree(PC_PASS n, TREE_INERTIA, pc_geometric(pc_lds_tree(PC_PASS n, TREE_INERTIA), rc, f));
  pc_sts_tree(PC_PASS up, TREE_INERTIA, pc_geometric(pc_lds_tree(PC_PASS up, TREE_INERTIA), rp, pc_negate(f)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  for (uint k = 0u; k < t.count; k++) pc_sts_tree(PC_PASS PC_NODE(m, t.first + k), TREE_INERTIA, pc_diagonal(PC_REAL(0.0)));
  pc_st3_tree(PC_PASS PC_NODE(m, t.first), TREE_PLACE, pc_zero3());
  for (uint k = 1u; k < t.count; k++) pc_tree_joint(PC_PASS t, PC_NODE(m, t.first + k), k);
  for (uint k = 0u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k); Index body = PC_ENDS(tree_ends, n, 0u);
    Quad turned = PC_GATHER(pose, body, 1u); Quad moments = PC_GATHER(mass, body, 0u); Quad inverse = PC_GATHER(mass, body, 1u);
    pc_st3_tree(PC_PASS n, TREE_FACING, turned.v); PC_ST(tree_rows, n, TREE_FACING + 3u, turned.s);
    pc_st3_tree(PC_PASS n, TREE_MOMENTS, inverse.v); PC_ST(tree_rows, n, TREE_MOMENTS + 3u, inverse.s);
    Sym3 inertia = pc_world_inertia(pc_quaternion(turned.v, turned.s), moments.v);
    Stiffened stiff = pc_stiffened(PC_PASS inertia, pc_lds_tree(PC_PASS n, TREE_INERTIA));
    pc_sts_tree(PC_PASS n, TREE_INERTIA, stiff.inertia); pc_sts_tree(PC_PASS n, TREE_BODY, inertia);
    PC_ST(tree_rows, n, TREE_FAST, stiff.fast);
    PC_ST(tree_rows, n, TREE_MASS, moments.s);
  }
}
