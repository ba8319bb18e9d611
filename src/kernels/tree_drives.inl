// After tree_prepare, where a joint of a tree has a motor or a spring: axes, distance from rest, coefficients, in units
// of the tree's mass. tree_solve_driven puts them into the factor (tree_drive.inl).
#include "tree_rows.inl"
#include "tree_drive_rows.inl"
#include "drive_terms.inl"

// Axes, the rotation from rest and the rates of the last sub-step, of what does more than damp.
PC_FN void pc_tree_drive_frame(PC_IO Slot n, Slot up, uint b, Index joint, Mask driven, Vec3 spin, Vec3 last) {
  Index child = PC_ENDS(tree_ends, n, 0u);
  Index parent = PC_ENDS(tree_ends, up, 0u);
  uint c_at = (1u - b) * 2u;
  uint p_at = b * 2u;
  Quad turn_c = PC_GATHER(pose, child, 1u);
  Quad turn_p = PC_GATHER(pose, parent, 1u);
  Quad axes_c = PC_GATHER(joint_frame, joint, c_at + 1u);
  Quad axes_p = PC_GATHER(joint_frame, joint, p_at + 1u);
  Quad rest = PC_GATHER(joint_drive, joint, 0u);
  Quaternion fc = pc_quaternion_mul(pc_quaternion(turn_c.v, turn_c.s), pc_quaternion(axes_c.v, axes_c.s));
  Quaternion fp = pc_quaternion_mul(pc_quaternion(turn_p.v, turn_p.s), pc_quaternion(axes_p.v, axes_p.s));
  // (zeros in lanes without)
  Mask flipped = PC_IS(b);
  Real one = PC_REAL(1.0);
  Real zero = PC_REAL(0.0);
  Real flip = pc_select(driven, pc_select(flipped, -one, one), zero);
  Quaternion fa;
  fa.v = pc_select3(flipped, fc.v, fp.v);
  fa.w = pc_select(flipped, fc.w, fp.w);
  Quaternion fb;
  fb.v = pc_select3(flipped, fp.v, fc.v);
  fb.w = pc_select(flipped, fp.w, fc.w);
  DriveFrame f = pc_drive_frame(fa, fb, pc_quaternion(rest.v, rest.s));
  // velocities of b against a are those of the child against the parent, or their opposites: so are the axes
  pc_st3_drive(PC_PASS n, DRIVE_AXIS, pc_scale(f.x, flip));
  pc_st3_drive(PC_PASS n, DRIVE_AXIS + 3u, pc_scale(f.y, flip));
  pc_st3_drive(PC_PASS n, DRIVE_AXIS + 6u, pc_scale(f.z, flip));
  pc_st3_drive(PC_PASS n, DRIVE_AWAY, pc_select3(driven, f.away, pc_zero3()));
  precise Real l0 = pc_dot(f.x, spin) * flip;
  precise Real l1 = pc_dot(f.y, spin) * flip;
  precise Real l2 = pc_dot(f.z, spin) * flip;
  pc_st3_drive(PC_PASS n, DRIVE_LAST, pc_select3(driven, Vec3(l0, l1, l2), last));
}
PC_FN void pc_tree_drive(PC_IO Slot n, Slot up, uint b, Index joint, Mask driven) {
  Real one = PC_REAL(1.0);
  Real zero = PC_REAL(0.0);
  Quad drive = PC_GATHER(joint_drive, joint, 1u);
  Mask moves = pc_and(driven, pc_max(pc_abs(drive.v.y), pc_abs(drive.v.z)) > zero);
  PC_ST(tree_drive_rows, n, DRIVE_IS, pc_select(moves, one, pc_select(driven, PC_REAL(2.0), zero)));
  Vec3 spin = pc_sub(pc_ld3_drive(PC_PASS n, DRIVE_SPIN), pc_ld3_drive(PC_PASS up, DRIVE_SPIN));
  Vec3 last = pc_select3(driven, spin, pc_zero3());
  pc_st3_drive(PC_PASS n, DRIVE_LAST, last);
  if (PC_ANY(moves)) {  // lint: allow (nothing reads it otherwise)
    pc_tree_drive_frame(PC_PASS n, up, b, joint, moves, spin, last);
  }
  Real fresh = pc_max(PC_LD(tree_drive_rows, n, DRIVE_FRESH), PC_LD(tree_drive_rows, up, DRIVE_FRESH));
  precise Real kick = PC_INFO(h) * (one - fresh * PC_REAL(0.5));
  Real share = pc_select(driven, pc_inverse_or_zero(PC_LD(tree_rows, n, TREE_TOTAL)), zero);
  precise Real most = drive.v.y * kick * share;
  precise Real stiffness = drive.v.z * share;
  precise Real damping = drive.s * share;
  PC_ST(tree_drive_rows, n, DRIVE_KICK, pc_select(driven, kick, zero));
  PC_ST(tree_drive_rows, n, MOTOR_SPEED, pc_select(driven, drive.v.x, zero));
  PC_ST(tree_drive_rows, n, MOTOR_MOST, most);
  PC_ST(tree_drive_rows, n, DRIVE_STIFFNESS, stiffness);
  PC_ST(tree_drive_rows, n, DRIVE_DAMPING, damping);
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index joint = PC_ENDS(tree_ends, n, 1u);
    Quad power = PC_GATHER(joint_drive, joint, 2u);
    Mask driven = power.v.x > PC_REAL(0.5);
    PC_ST(tree_drive_rows, n, DRIVE_IS, PC_REAL(0.0));
    if (PC_ANY(driven)) {  // lint: allow (nothing reads them otherwise)
      pc_tree_drive(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)), pc_is_flipped(PC_PASS t, k), joint,
                    driven);
    }
  }
}
