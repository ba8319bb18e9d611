// Start of a step of a tree of fourth order (smooth_step.inl): what all of its stages read of bodies and joints.
#include "smooth_rows.inl"
#include "tree_store.inl"

PC_FN void pc_smooth_mass(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Quad moments = PC_GATHER(mass, body, 0u);
  Quad inverse = PC_GATHER(mass, body, 1u);
  Quad push = PC_GATHER(force, body, 0u);
  Quad turn = PC_GATHER(force, body, 1u);
  PC_ST(tree_rows, n, TREE_MASS, moments.s);
  pc_st3_tree(PC_PASS n, SMOOTH_MOMENTS, moments.v);
  pc_st3_tree(PC_PASS n, TREE_MOMENTS, inverse.v);
  PC_ST(tree_rows, n, TREE_MOMENTS + 3u, inverse.s);
  pc_st3_tree(PC_PASS n, SMOOTH_FORCE, push.v);
  pc_st3_tree(PC_PASS n, SMOOTH_TORQUE, turn.v);
  // as in begin
  Quad low = PC_GATHER(velocity_parts, body, 3u);
  precise Real settling = low.s - PC_REAL(1.0);
  low.s = pc_max(settling, PC_REAL(0.0));
  PC_SCATTER_IF(moments.s > PC_REAL(0.0), velocity_parts, body, 3u, low);
}
PC_FN void pc_smooth_joint(PC_IO Tree t, Slot n, uint k) {
  Index joint = PC_ENDS(tree_ends, n, 1u);
  // quads of joint_solved: 0 of body a, 2 of body b
  uint b = pc_is_flipped(PC_PASS t, k);
  uint c_at = (1u - b) * 2u;
  uint p_at = b * 2u;
  Quad anchor_c = PC_GATHER(joint_solved, joint, c_at);
  Quad anchor_p = PC_GATHER(joint_solved, joint, p_at);
  pc_st3_tree(PC_PASS n, SMOOTH_ANCHOR, anchor_c.v);
  pc_st3_tree(PC_PASS n, SMOOTH_UP_ANCHOR, anchor_p.v);
}
PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Real total = PC_REAL(0.0);
  PC_NODES(k, 0u, t) {
    pc_smooth_mass(PC_PASS PC_NODE(m, t.first + k));
    PC_THEN(PC_ALL(k, 0u, t)) precise Real sum = total + PC_LD(tree_rows, PC_NODE(m, t.first + k), TREE_MASS);
    total = sum;
  }
  PC_NODES(k, 1u, t) pc_smooth_joint(PC_PASS t, PC_NODE(m, t.first + k), k);
  Real share = pc_inverse_or_zero(total);
  Vec3 zero = pc_zero3();
  Six none = pc_six(zero, zero);
  PC_MEET;
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    precise Real own = PC_LD(tree_rows, n, TREE_MASS) * share;
    PC_ST(tree_rows, n, TREE_TOTAL, total);
    PC_ST(tree_rows, n, TREE_MASS, own);
    pc_st3_tree(PC_PASS n, SMOOTH_MOMENTS, pc_scale(pc_ld3_tree(PC_PASS n, SMOOTH_MOMENTS), share));
    PC_ST(tree_rows, n, TREE_HAS_ROWS, PC_REAL(0.0));
    PC_ST(tree_rows, n, TREE_PIVOT, PC_REAL(0.0));
    pc_st6_tree(PC_PASS n, TREE_OUTSIDE, none);
    // stiffness is known, and is none (tree_factor.inl)
    PC_ST(tree_rows, n, TREE_FAST, PC_TINY);
  }
}
