// End of a step of a tree of fourth order: the velocities in phase with the pose, from those of half a stage before it. Forces kick
// by half of the stage, and the pins' impulses leave no pin a velocity (RATTLE). And what acted on the pins in the last stage, for
// the next step, as an impulse of the world's sub-step.
#include "smooth_tree.inl"

PC_FN void pc_smooth_phase(PC_IO Slot n, Real kick) {
  Index body = PC_ENDS(tree_ends, n, 0u); Quad linear = PC_GATHER(motion, body, 0u); Quad angular = PC_GATHER(motion, body, 1u); Mask moves = linear.s > PC_REAL(0.0);
  Vec3 acceleration = pc_madd(Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z)), pc_ld3_tree(PC_PASS n, SMOOTH_FORCE), linear.s);
  Vec3 u = pc_madd(linear.v, acceleration, kick); Vec3 l = pc_madd(angular.v, pc_ld3_tree(PC_PASS n, SMOOTH_TORQUE), kick);
  pc_st3_tree(PC_PASS n, SMOOTH_U, pc_select3(moves, u, pc_zero3())); pc_st3_tree(PC_PASS n, SMOOTH_L, pc_select3(moves, l, pc_zero3()));
  pc_st3_tree(PC_PASS n, TREE_X + 3u, pc_sym_mul(pc_world_inertia(pc_smooth_facing(PC_PASS n), pc_ld3_tree(PC_PASS n, TREE_MOMENTS)), pc_ld3_tree(PC_PASS n, SMOOTH_L)));
}
PC_FN void pc_smooth_rates(PC_IO Slot n, Slot up) {
  precise Vec3 c = (pc_ld3_tree(PC_PASS n, SMOOTH_U) - pc_ld3_tree(PC_PASS up, SMOOTH_U)) + (pc_cross(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS n, TREE_RC)) - pc_cross(pc_ld3_tree(PC_PASS up, TREE_X + 3u), pc_ld3_tree(PC_PASS n, TREE_RP)));
  pc_st3_tree(PC_PASS n, TREE_C, c);
}
PC_FN void pc_smooth_halves(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u); Quad linear = PC_GATHER(motion, body, 0u); Quad angular = PC_GATHER(motion, body, 1u); Mask moves = linear.s > PC_REAL(0.0);
  Vec3 u = pc_snap3(pc_sub(pc_ld3_tree(PC_PASS n, SMOOTH_U), linear.v)); Vec3 l = pc_snap3(pc_sub(pc_ld3_tree(PC_PASS n, SMOOTH_L), angular.v));
  PC_SCATTER_IF(moves, velocity_parts, body, 0u, pc_quad(u, PC_REAL(0.0))); PC_SCATTER_IF(moves, velocity_parts, body, 1u, pc_quad(l, PC_REAL(0.0)));
}
PC_FN void pc_smooth_remember(PC_IO Tree t, Slot n, uint k) {
  Real flip = pc_select(PC_IS(pc_is_flipped(PC_PASS t, k)), PC_REAL(-1.0), PC_REAL(1.0)); Index joint = PC_ENDS(tree_ends, n, 1u);
  precise Vec3 pin = pc_ld3_tree(PC_PASS n, TREE_PIN) * flip * PC_LD(tree_rows, n, TREE_TOTAL) * PC_INFO(impulse_ratio);
  PC_SCATTER(joint_impulse, joint, 0u, pc_quad(pc_snap3(pin), PC_REAL(0.0))); PC_SCATTER(joint_impulse, joint, 1u, pc_quad(pc_zero3(), PC_REAL(0.0)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m); precise Real kick = PC_INFO(h_before) * PC_REAL(0.5);
  for (uint k = 1u; k < t.count; k++) pc_smooth_remember(PC_PASS t, PC_NODE(m, t.first + k), k);
  pc_smooth_look(PC_PASS m, t);
  for (uint k = 0u; k < t.count; k++) pc_smooth_phase(PC_PASS PC_NODE(m, t.first + k), kick);
  for (uint k = 1u; k < t.count; k++) pc_smooth_rates(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
  pc_factor(PC_PASS m, t);
  pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PUSH, PC_REAL(0.0));
  pc_smooth_take(PC_PASS m, t);
  for (uint k = 0u; k < t.count; k++) pc_smooth_halves(PC_PASS PC_NODE(m, t.first + k));
}
