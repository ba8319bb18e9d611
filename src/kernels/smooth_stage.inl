// A stage of the fourth order of joint trees (docs/integrate.md): a sub-step of its own length, which may be negative, that is
// symmetric in time. Forces kick by half of the stage before and half of this one; the pins' impulses act along the arms at its
// start and close every gap at its end, to rounding (SHAKE; Hairer, Lubich, Wanner, Geometric Numerical Integration VII.1.4):
//   u' = u + a (h_before + h) / 2 + M^-1 G(q)^T f,  q' = q moved by h u',  g(q') = 0.
// Stages of the lengths that info gives make a step of fourth order, since each is of second and symmetric (M. Suzuki, Physics
// Letters A 146, 1990, 319). No stiffness in the inertia and no damping: neither is symmetric.
#include "smooth_tree.inl"
#include "free_rotation.inl"
#include "tree_swing.inl"
#include "turned.inl"

// Reads the velocities, kicked by the forces.
PC_FN void pc_smooth_kick(PC_IO Slot n, Real kick) {
  Index body = PC_ENDS(tree_ends, n, 0u); Quad linear = PC_GATHER(motion, body, 0u); Quad angular = PC_GATHER(motion, body, 1u);
  Quad linear_low = PC_GATHER(velocity_parts, body, 2u); Quad angular_low = PC_GATHER(velocity_parts, body, 3u);
  Mask moves = linear.s > PC_REAL(0.0); Vec3 acceleration = pc_madd(Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z)), pc_ld3_tree(PC_PASS n, SMOOTH_FORCE), linear.s);
  precise Vec3 u_change = acceleration * kick + linear_low.v; precise Vec3 l_change = pc_ld3_tree(PC_PASS n, SMOOTH_TORQUE) * kick + angular_low.v;
  TwoSum u = pc_two_sum(linear.v, u_change); TwoSum l = pc_two_sum(angular.v, l_change);
  pc_st3_tree(PC_PASS n, SMOOTH_U, pc_select3(moves, pc_snap3(u.sum), pc_zero3())); pc_st3_tree(PC_PASS n, SMOOTH_L, pc_select3(moves, pc_snap3(l.sum), pc_zero3()));
  linear_low.v = pc_snap3(u.low); angular_low.v = pc_snap3(l.low);
  PC_SCATTER_IF(moves, velocity_parts, body, 2u, linear_low); PC_SCATTER_IF(moves, velocity_parts, body, 3u, angular_low);
}
// Where the stage turns a body: what it changes in the orientation, and the turn itself.
PC_FN void pc_smooth_turn(PC_IO Slot n) {
  Vec3 l = pc_ld3_tree(PC_PASS n, SMOOTH_L); precise Real spin = pc_abs(l.x) + pc_abs(l.y) + pc_abs(l.z); Quaternion still = pc_quaternion(pc_zero3(), PC_REAL(0.0)); Quaternion change = still; Quaternion turn = still;
  if (PC_ANY(pc_nonzero(spin))) {  // lint: allow (a turn of nothing)
    Quaternion q = pc_smooth_facing(PC_PASS n); change = pc_free_rotation(q, l, pc_quad(pc_ld3_tree(PC_PASS n, TREE_MOMENTS), PC_LD(tree_rows, n, TREE_MOMENTS + 3u)), PC_INFO(h));
    turn = pc_quaternion_mul(change, pc_conjugate(q));
  }
  pc_st3_tree(PC_PASS n, SMOOTH_CHANGE, change.v); PC_ST(tree_rows, n, SMOOTH_CHANGE + 3u, change.w); pc_st3_tree(PC_PASS n, TREE_TURN, turn.v); PC_ST(tree_rows, n, TREE_TURN + 3u, turn.w);
}
// The rates of the pins over the stage, as right-hand sides; 1 where what they open by is more than a share, given as its square, of the arm.
PC_FN Real pc_smooth_residual(PC_IO Slot m, Tree t, Real share_squared) {
  Real left = PC_REAL(0.0);
  for (uint k = 1u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k); Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k)); Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
    Vec3 swung = pc_sub(pc_swing(PC_PASS n, rc), pc_swing(PC_PASS up, pc_ld3_tree(PC_PASS n, TREE_RP)));
    precise Vec3 apart = (pc_ld3_tree(PC_PASS n, SMOOTH_U) - pc_ld3_tree(PC_PASS up, SMOOTH_U)) * PC_INFO(h) + swung;
    pc_st3_tree(PC_PASS n, TREE_C, pc_scale(apart, PC_INFO(inverse_h))); precise Real most = pc_dot(rc, rc) * share_squared;
    left = pc_select(pc_dot(apart, apart) > most, PC_REAL(1.0), left);
  }
  return left;
}
// What closes gaps of more than 32 epsilon of the arm, which rounding left: the bodies move by it, their velocities do not keep it. TREE_X
// holds it, or nothing.
PC_FN void pc_smooth_push(PC_IO Slot m, Tree t) {
  precise Real noise = PC_INFO(rounding) * PC_INFO(rounding); Real open = PC_REAL(0.0);
  for (uint k = 0u; k < t.count; k++) pc_st6_tree(PC_PASS PC_NODE(m, t.first + k), TREE_X, pc_six(pc_zero3(), pc_zero3()));
  for (uint k = 1u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k); Vec3 gap = pc_ld3_tree(PC_PASS n, TREE_GAP); Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC); precise Real most = pc_dot(rc, rc) * noise;
    Mask here = pc_dot(gap, gap) > most; open = pc_select(here, PC_REAL(1.0), open);
    Real size = pc_length(gap); precise Real far = pc_abs(PC_INFO(h)) * PC_INFO(joint_push_speed); Real share = pc_select(size > far, pc_div(far, pc_max(size, far)), PC_REAL(1.0));
    precise Real rate = share * PC_INFO(inverse_h); pc_st3_tree(PC_PASS n, TREE_C, pc_select3(here, pc_scale(gap, rate), pc_zero3()));
  }
  if (!PC_ANY(open > PC_REAL(0.5))) return;  // lint: allow (a push of nothing changes nothing)
  pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PUSH, PC_REAL(0.0));
  for (uint k = 0u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k); Vec3 kept = pc_ld3_tree(PC_PASS n, SMOOTH_L); Vec3 spun = pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), pc_ld3_tree(PC_PASS n, TREE_X + 3u));
    pc_st3_tree(PC_PASS n, SMOOTH_L, pc_madd(kept, spun, PC_LD(tree_rows, n, TREE_TOTAL)));
    pc_smooth_turn(PC_PASS n);
    pc_st3_tree(PC_PASS n, SMOOTH_L, kept);
  }
}
// The pose at the stage's end, and the velocities.
PC_FN void pc_smooth_move(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u); Quad linear = PC_GATHER(motion, body, 0u); Quad place = PC_GATHER(pose, body, 0u); Quad place_low = PC_GATHER(pose, body, 2u); Quad turned_low = PC_GATHER(pose, body, 3u);
  Mask moves = linear.s > PC_REAL(0.0); linear.v = pc_ld3_tree(PC_PASS n, SMOOTH_U);
  Vec3 way = pc_scale(pc_add(linear.v, pc_ld3_tree(PC_PASS n, TREE_X)), PC_INFO(h)); TwoSum p = pc_two_sum(place.v, pc_add(place_low.v, way));
  place.v = p.sum; place_low.v = pc_snap3(p.low);
  Turned next = pc_turned(pc_smooth_facing(PC_PASS n), turned_low, pc_quaternion(pc_ld3_tree(PC_PASS n, SMOOTH_CHANGE), PC_LD(tree_rows, n, SMOOTH_CHANGE + 3u)));
  PC_SCATTER_IF(moves, pose, body, 0u, place); PC_SCATTER_IF(moves, pose, body, 1u, next.q); PC_SCATTER_IF(moves, pose, body, 2u, place_low); PC_SCATTER_IF(moves, pose, body, 3u, next.low);
  PC_SCATTER_IF(moves, motion, body, 0u, linear); PC_SCATTER_IF(moves, motion, body, 1u, pc_quad(pc_ld3_tree(PC_PASS n, SMOOTH_L), PC_REAL(0.0)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m); precise Real kick = (PC_INFO(h_before) + PC_INFO(h)) * PC_REAL(0.5);
  precise Real share = PC_INFO(rounding) * PC_REAL(0.25); precise Real noise = share * share; Real wanted = PC_REAL(1.0);
  pc_smooth_look(PC_PASS m, t);
  for (uint k = 0u; k < t.count; k++) pc_smooth_kick(PC_PASS PC_NODE(m, t.first + k), kick);
  pc_factor(PC_PASS m, t);
  // Newton's method, with the factor at the stage's start; what is left of a lane that is done are steps of nothing
  for (uint turn = 0u; turn < 9u; turn++) {
    for (uint k = 0u; k < t.count; k++) pc_smooth_turn(PC_PASS PC_NODE(m, t.first + k));
    wanted = pc_min(wanted, pc_smooth_residual(PC_PASS m, t, noise));
    if (turn == 8u || !PC_ANY(wanted > PC_REAL(0.5))) break;  // lint: allow (a lane that is done takes nothing)
    for (uint k = 1u; k < t.count; k++) { Slot n = PC_NODE(m, t.first + k); pc_st3_tree(PC_PASS n, TREE_C, pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), wanted)); }
    pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PUSH, PC_REAL(0.0));
    pc_smooth_take(PC_PASS m, t);
  }
  pc_smooth_push(PC_PASS m, t);
  for (uint k = 0u; k < t.count; k++) pc_smooth_move(PC_PASS PC_NODE(m, t.first + k));
}
