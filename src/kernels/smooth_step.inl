// A sub-step of fourth order of a joint tree on which nothing but forces and pins acts (docs/integrate.md). What moves
// freely in it are the turns of its bodies and the place of its root; pins give the rest. Four stages of Runge and
// Kutta: with L the angular momenta, q = exp(theta) q0, and l and alpha what the tree's factor answers to forces, to
// the pull of what turns and to L x w,
//   L' = I alpha + w x L,   theta' = w - theta x w / 2 + theta x (theta x w) / 12,   p_root'' = l
// (H. Munthe-Kaas, BIT 38, 1998, 92). Pins hold to rounding whatever the sub-step: places follow from turns.
//
// Between sub-steps velocities stand half a sub-step behind the pose, as everywhere. Those that are read are taken up
// again where they fit the pins, as this order leaves them. Others (of second order, or set by the host) come into
// phase by forces alone, and then onto the pins, by impulses along the arms of that pose: whatever such impulses were
// given to them before makes no difference.
#include "smooth_rows.inl"
#include "tree_store.inl"
#include "tree_factor.inl"
#include "tree_sweep.inl"
#include "turned.inl"

PC_FN Quaternion pc_smooth_facing(PC_IO Slot n) {
  return pc_quaternion(pc_ld3_tree(PC_PASS n, TREE_FACING), PC_LD(tree_rows, n, TREE_FACING + 3u));
}
PC_FN Mask pc_smooth_moves(PC_IO Slot n) { return PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0); }
PC_FN Vec3 pc_smooth_product(Vec3 a, Vec3 b) {
  precise Real x = a.x * b.x;
  precise Real y = a.y * b.y;
  precise Real z = a.z * b.z;
  return Vec3(x, y, z);
}

PC_FN void pc_smooth_spin(PC_IO Slot n, Quaternion q) {
  pc_st3_tree(PC_PASS n, SMOOTH_W,
              pc_rotate(q, pc_smooth_product(pc_ld3_tree(PC_PASS n, TREE_MOMENTS),
                                             pc_rotate(pc_conjugate(q), pc_ld3_tree(PC_PASS n, SMOOTH_L)))));
}
// Of a node that faces q: inertia, and the angular velocity that its momentum gives it.
PC_FN void pc_smooth_face(PC_IO Slot n, Quaternion q) {
  pc_st3_tree(PC_PASS n, TREE_FACING, q.v);
  PC_ST(tree_rows, n, TREE_FACING + 3u, q.w);
  Sym3 inertia = pc_world_inertia(q, pc_ld3_tree(PC_PASS n, SMOOTH_MOMENTS));
  pc_sts_tree(PC_PASS n, TREE_INERTIA, inertia);
  pc_smooth_spin(PC_PASS n, q);
}
PC_FN void pc_smooth_arms(PC_IO Slot n, Slot up) {
  pc_st3_tree(PC_PASS n, TREE_RC, pc_rotate(pc_smooth_facing(PC_PASS n), pc_ld3_tree(PC_PASS n, SMOOTH_ANCHOR)));
  pc_st3_tree(PC_PASS n, TREE_RP, pc_rotate(pc_smooth_facing(PC_PASS up), pc_ld3_tree(PC_PASS n, SMOOTH_UP_ANCHOR)));
}

// Adds to what stands as a sum of two reals: the rounding of each sub-step would add up.
PC_FN void pc_smooth_add(PC_IO Slot n, uint high, uint low, Vec3 change) {
  TwoSum s = pc_two_sum(pc_ld3_tree(PC_PASS n, high), pc_add(pc_ld3_tree(PC_PASS n, low), change));
  pc_st3_tree(PC_PASS n, high, s.sum);
  pc_st3_tree(PC_PASS n, low, s.low);
}
// What forces alone give to a node's velocities in half a sub-step.
struct Kick {
  Vec3 u;
  Vec3 l;
};
PC_FN Kick pc_smooth_kick(PC_IO Slot n, Real inverse_mass, Real h) {
  precise Real half_h = h * PC_REAL(0.5);
  Vec3 acceleration = pc_madd(Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z)),
                              pc_ld3_tree(PC_PASS n, SMOOTH_FORCE), inverse_mass);
  Kick kick;
  kick.u = pc_snap3(pc_scale(acceleration, half_h));
  kick.l = pc_snap3(pc_scale(pc_ld3_tree(PC_PASS n, SMOOTH_TORQUE), half_h));
  return kick;
}
// The pose and the velocities that a node begins with.
PC_FN void pc_smooth_start(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Quad linear = PC_GATHER(motion, body, 0u);
  Quad angular = PC_GATHER(motion, body, 1u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Quad u = PC_GATHER(velocity_parts, body, 0u);
  Quad l = PC_GATHER(velocity_parts, body, 1u);
  Quad u_low = PC_GATHER(velocity_parts, body, 2u);
  Quad l_low = PC_GATHER(velocity_parts, body, 3u);
  Vec3 zero = pc_zero3();
  Mask moves = linear.s > PC_REAL(0.0);
  TwoSum v = pc_two_sum(linear.v, pc_add(u.v, u_low.v));
  TwoSum spin = pc_two_sum(angular.v, pc_add(l.v, l_low.v));
  pc_st3_tree(PC_PASS n, SMOOTH_V, pc_select3(moves, v.sum, zero));
  pc_st3_tree(PC_PASS n, SMOOTH_L, pc_select3(moves, spin.sum, zero));
  pc_st3_tree(PC_PASS n, SMOOTH_V_LOW, pc_select3(moves, v.low, zero));
  pc_st3_tree(PC_PASS n, SMOOTH_L_LOW, pc_select3(moves, spin.low, zero));
  pc_smooth_face(PC_PASS n, pc_quaternion(turned.v, turned.s));
  pc_st6_tree(PC_PASS n, TREE_OUTSIDE, pc_six(zero, zero));
}
// In lanes that want it the velocities by forces alone, of a body whose are not in phase.
PC_FN void pc_smooth_restart(PC_IO Slot n, Mask wanted) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Quad linear = PC_GATHER(motion, body, 0u);
  Quad angular = PC_GATHER(motion, body, 1u);
  Quad u_low = PC_GATHER(velocity_parts, body, 2u);
  Quad l_low = PC_GATHER(velocity_parts, body, 3u);
  Mask kicked = pc_and(wanted, pc_and(linear.s > PC_REAL(0.0), angular.s > PC_REAL(-0.5)));
  Kick kick = pc_smooth_kick(PC_PASS n, linear.s, PC_INFO(h_before));
  TwoSum v = pc_two_sum(linear.v, pc_add(kick.u, u_low.v));
  TwoSum spin = pc_two_sum(angular.v, pc_add(kick.l, l_low.v));
  pc_st3_tree(PC_PASS n, SMOOTH_V, pc_select3(kicked, v.sum, pc_ld3_tree(PC_PASS n, SMOOTH_V)));
  pc_st3_tree(PC_PASS n, SMOOTH_V_LOW, pc_select3(kicked, v.low, pc_ld3_tree(PC_PASS n, SMOOTH_V_LOW)));
  pc_st3_tree(PC_PASS n, SMOOTH_L, pc_select3(kicked, spin.sum, pc_ld3_tree(PC_PASS n, SMOOTH_L)));
  pc_st3_tree(PC_PASS n, SMOOTH_L_LOW, pc_select3(kicked, spin.low, pc_ld3_tree(PC_PASS n, SMOOTH_L_LOW)));
  pc_smooth_spin(PC_PASS n, pc_smooth_facing(PC_PASS n));
}
// The rate of a node's pin, to be undone; 1 where it is more than rounding.
PC_FN Real pc_smooth_rate(PC_IO Slot n, Slot up) {
  Vec3 v = pc_ld3_tree(PC_PASS n, SMOOTH_V);
  Vec3 v_up = pc_ld3_tree(PC_PASS up, SMOOTH_V);
  Vec3 swung = pc_sub(pc_cross(pc_ld3_tree(PC_PASS n, SMOOTH_W), pc_ld3_tree(PC_PASS n, TREE_RC)),
                      pc_cross(pc_ld3_tree(PC_PASS up, SMOOTH_W), pc_ld3_tree(PC_PASS n, TREE_RP)));
  Vec3 c = pc_add(pc_sub(v, v_up), swung);
  pc_st3_tree(PC_PASS n, TREE_C, c);
  precise Real noise = (pc_length(v) + pc_length(v_up)) * PC_INFO(rounding);
  return pc_select(pc_length(c) > noise, PC_REAL(1.0), PC_REAL(0.0));
}
// What brings the velocities onto the pins, with the factor at the start; 1 where any does.
PC_FN Real pc_smooth_off_pins(PC_IO Slot m, Tree t) {
  Real open = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    open = pc_max(open, pc_smooth_rate(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k))));
  }
  PC_MOST(open);
  if (!PC_ANY(open > PC_REAL(0.5))) return open;  // lint: allow (a rate of nothing changes nothing)
  PC_NODES(k, 0u, t) pc_smooth_restart(PC_PASS PC_NODE(m, t.first + k), open > PC_REAL(0.5));
  PC_MEET;
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_smooth_rate(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
    pc_st3_tree(PC_PASS n, TREE_C, pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), open));
  }
  return open;
}
// What that sweep has changed.
PC_FN void pc_smooth_onto_pins(PC_IO Slot n) {
  Vec3 spun = pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_INERTIA), pc_ld3_tree(PC_PASS n, TREE_X + 3u));
  pc_smooth_add(PC_PASS n, SMOOTH_V, SMOOTH_V_LOW, pc_ld3_tree(PC_PASS n, TREE_X));
  pc_smooth_add(PC_PASS n, SMOOTH_L, SMOOTH_L_LOW, pc_scale(spun, PC_LD(tree_rows, n, TREE_TOTAL)));
  pc_st3_tree(PC_PASS n, SMOOTH_W, pc_add(pc_ld3_tree(PC_PASS n, SMOOTH_W), pc_ld3_tree(PC_PASS n, TREE_X + 3u)));
}
// Where the first stage begins.
PC_FN void pc_smooth_begin(PC_IO Slot n) {
  Vec3 zero = pc_zero3();
  pc_st3_tree(PC_PASS n, SMOOTH_START, pc_ld3_tree(PC_PASS n, SMOOTH_L));
  pc_st3_tree(PC_PASS n, SMOOTH_TURN, zero);
  pc_st3_tree(PC_PASS n, SMOOTH_L_SUM, zero);
  pc_st3_tree(PC_PASS n, SMOOTH_TURN_SUM, zero);
  pc_st3_tree(PC_PASS n, SMOOTH_V_SUM, zero);
  pc_st3_tree(PC_PASS n, SMOOTH_WAY_SUM, zero);
}

// What acts on a node from outside of its pins, and what turning makes its pin open with.
PC_FN void pc_smooth_load(PC_IO Slot n) {
  Real share = pc_inverse_or_zero(PC_LD(tree_rows, n, TREE_TOTAL));
  Real mass = PC_LD(tree_rows, n, TREE_MASS);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  precise Vec3 push = gravity * mass + pc_ld3_tree(PC_PASS n, SMOOTH_FORCE) * share;
  precise Vec3 turn = (pc_ld3_tree(PC_PASS n, SMOOTH_TORQUE) -
                       pc_cross(pc_ld3_tree(PC_PASS n, SMOOTH_W), pc_ld3_tree(PC_PASS n, SMOOTH_L))) *
                      share;
  pc_st6_tree(PC_PASS n, TREE_OUTSIDE, pc_six(push, turn));
}
PC_FN Vec3 pc_smooth_pull(Vec3 w, Vec3 r) { return pc_cross(w, pc_cross(w, r)); }
PC_FN void pc_smooth_open(PC_IO Slot n, Slot up) {
  pc_st3_tree(PC_PASS n, TREE_C,
              pc_sub(pc_smooth_pull(pc_ld3_tree(PC_PASS n, SMOOTH_W), pc_ld3_tree(PC_PASS n, TREE_RC)),
                     pc_smooth_pull(pc_ld3_tree(PC_PASS up, SMOOTH_W), pc_ld3_tree(PC_PASS n, TREE_RP))));
}
// After a stage's sweep: its share of the sums, and with `next` of time the state of the stage after it.
PC_FN void pc_smooth_gain(PC_IO Slot n, Real weight, Real way_weight, Real next) {
  Vec3 w = pc_ld3_tree(PC_PASS n, SMOOTH_W);
  Vec3 turn = pc_ld3_tree(PC_PASS n, SMOOTH_TURN);
  Vec3 answer = pc_ld3_tree(PC_PASS n, TREE_X);
  Vec3 spun = pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_INERTIA), pc_ld3_tree(PC_PASS n, TREE_X + 3u));
  precise Vec3 l_rate = spun * PC_LD(tree_rows, n, TREE_TOTAL) + pc_cross(w, pc_ld3_tree(PC_PASS n, SMOOTH_L));
  Vec3 across = pc_cross(turn, w);
  precise Vec3 turn_rate = w - across * PC_REAL(0.5) + pc_cross(turn, across) * PC_TWELFTH;
  pc_st3_tree(PC_PASS n, SMOOTH_L_SUM, pc_madd(pc_ld3_tree(PC_PASS n, SMOOTH_L_SUM), l_rate, weight));
  pc_st3_tree(PC_PASS n, SMOOTH_TURN_SUM, pc_madd(pc_ld3_tree(PC_PASS n, SMOOTH_TURN_SUM), turn_rate, weight));
  pc_st3_tree(PC_PASS n, SMOOTH_V_SUM, pc_madd(pc_ld3_tree(PC_PASS n, SMOOTH_V_SUM), answer, weight));
  pc_st3_tree(PC_PASS n, SMOOTH_WAY_SUM, pc_madd(pc_ld3_tree(PC_PASS n, SMOOTH_WAY_SUM), answer, way_weight));
  pc_st3_tree(PC_PASS n, SMOOTH_TURN, pc_scale(turn_rate, next));
  pc_st3_tree(PC_PASS n, SMOOTH_L, pc_scale(l_rate, next));
}
// The state of a stage but the first.
PC_FN void pc_smooth_turn(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Turn turn = pc_turn(pc_ld3_tree(PC_PASS n, SMOOTH_TURN));
  pc_st3_tree(PC_PASS n, SMOOTH_L, pc_add(pc_ld3_tree(PC_PASS n, SMOOTH_START), pc_ld3_tree(PC_PASS n, SMOOTH_L)));
  pc_smooth_face(PC_PASS n, pc_quaternion_mul(turn.q, pc_quaternion(turned.v, turned.s)));
}

// How much of a gap the sub-step closes: what is more than 32 epsilon of the arm, but no faster than joint_push_speed.
PC_FN Vec3 pc_smooth_closing(PC_IO Vec3 gap, Vec3 arm) {
  Real size = pc_length(gap);
  precise Real most = PC_INFO(h) * PC_INFO(joint_push_speed);
  precise Real noise = pc_length(arm) * PC_INFO(rounding);
  Real share = pc_share_within(size, most);
  return pc_select3(size > noise, pc_scale(gap, share), pc_zero3());
}
PC_FN Vec3 pc_smooth_swing(Turn turn, Vec3 r) {
  Vec3 s = pc_scale(pc_cross(turn.q.v, r), PC_REAL(2.0));
  precise Vec3 d = s * turn.q.w + pc_cross(turn.q.v, s);
  return d;
}
// How far a node moves: with its parent, by what both arms swing, and by what closes the gap.
// Its arms and velocity at the end.
PC_FN void pc_smooth_follow(PC_IO Slot n, Slot up) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Index above = PC_ENDS(tree_ends, up, 0u);
  Quad place = PC_GATHER(pose, body, 0u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Quad low = PC_GATHER(pose, body, 2u);
  Quad place_up = PC_GATHER(pose, above, 0u);
  Quad turned_up = PC_GATHER(pose, above, 1u);
  Quad low_up = PC_GATHER(pose, above, 2u);
  Vec3 rc = pc_rotate(pc_quaternion(turned.v, turned.s), pc_ld3_tree(PC_PASS n, SMOOTH_ANCHOR));
  Vec3 rp = pc_rotate(pc_quaternion(turned_up.v, turned_up.s), pc_ld3_tree(PC_PASS n, SMOOTH_UP_ANCHOR));
  Vec3 apart = pc_add(pc_sub(place.v, place_up.v), pc_sub(low.v, low_up.v));
  Vec3 gap = pc_add(apart, pc_sub(rc, rp));
  Vec3 swing = pc_smooth_swing(pc_turn(pc_ld3_tree(PC_PASS n, SMOOTH_TURN)), rc);
  Vec3 swing_up = pc_smooth_swing(pc_turn(pc_ld3_tree(PC_PASS up, SMOOTH_TURN)), rp);
  precise Vec3 way = pc_ld3_tree(PC_PASS up, SMOOTH_WAY_SUM) + (swing_up - swing) - pc_smooth_closing(PC_PASS gap, rc);
  pc_st3_tree(PC_PASS n, SMOOTH_WAY_SUM, way);
  Vec3 arm = pc_add(rc, swing);
  Vec3 arm_up = pc_add(rp, swing_up);
  Vec3 swung =
      pc_sub(pc_cross(pc_ld3_tree(PC_PASS up, SMOOTH_W), arm_up), pc_cross(pc_ld3_tree(PC_PASS n, SMOOTH_W), arm));
  pc_st3_tree(PC_PASS n, SMOOTH_V, pc_add(pc_ld3_tree(PC_PASS up, SMOOTH_V), swung));
  pc_st3_tree(PC_PASS n, SMOOTH_V_LOW, pc_zero3());
  pc_st3_tree(PC_PASS n, TREE_RC, arm);
  pc_st3_tree(PC_PASS n, TREE_RP, arm_up);
}
// What its pin does to a node and to its parent at the end.
PC_FN void pc_smooth_pin(PC_IO Slot n) {
  Vec3 f = pc_ld3_tree(PC_PASS n, TREE_PIN);
  Real light = pc_inverse_or_zero(PC_LD(tree_rows, n, TREE_MASS));
  Real total = PC_LD(tree_rows, n, TREE_TOTAL);
  pc_st3_tree(PC_PASS n, SMOOTH_V_SUM, pc_madd(pc_ld3_tree(PC_PASS n, SMOOTH_V_SUM), f, light));
  pc_st3_tree(PC_PASS n, SMOOTH_L_SUM,
              pc_madd(pc_ld3_tree(PC_PASS n, SMOOTH_L_SUM), pc_cross(pc_ld3_tree(PC_PASS n, TREE_RC), f), total));
}
PC_FN void pc_smooth_pin_parent(PC_IO Slot n, Slot up) {
  Vec3 f = pc_ld3_tree(PC_PASS n, TREE_PIN);
  precise Real light_up = -pc_inverse_or_zero(PC_LD(tree_rows, up, TREE_MASS));
  precise Real back = -PC_LD(tree_rows, n, TREE_TOTAL);
  pc_st3_tree(PC_PASS up, SMOOTH_V_SUM, pc_madd(pc_ld3_tree(PC_PASS up, SMOOTH_V_SUM), f, light_up));
  pc_st3_tree(PC_PASS up, SMOOTH_L_SUM,
              pc_madd(pc_ld3_tree(PC_PASS up, SMOOTH_L_SUM), pc_cross(pc_ld3_tree(PC_PASS n, TREE_RP), f), back));
}
// The sums of all stages: momentum, turn and angular velocity at the end.
PC_FN void pc_smooth_finish(PC_IO Slot n) {
  precise Real sixth = PC_INFO(h) * PC_SIXTH;
  pc_st3_tree(PC_PASS n, SMOOTH_L, pc_ld3_tree(PC_PASS n, SMOOTH_START));
  pc_smooth_add(PC_PASS n, SMOOTH_L, SMOOTH_L_LOW, pc_scale(pc_ld3_tree(PC_PASS n, SMOOTH_L_SUM), sixth));
  pc_st3_tree(PC_PASS n, SMOOTH_L_SUM, pc_zero3());
  pc_st3_tree(PC_PASS n, SMOOTH_V_SUM, pc_zero3());
  pc_st3_tree(PC_PASS n, SMOOTH_TURN, pc_scale(pc_ld3_tree(PC_PASS n, SMOOTH_TURN_SUM), sixth));
}
// Stores a node: the pose, and velocities half a sub-step behind it.
PC_FN void pc_smooth_store(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Mask moves = pc_smooth_moves(PC_PASS n);
  Quad linear = PC_GATHER(motion, body, 0u);
  Quad place = PC_GATHER(pose, body, 0u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Quad place_low = PC_GATHER(pose, body, 2u);
  Quad turned_low = PC_GATHER(pose, body, 3u);
  Quad u_low = PC_GATHER(velocity_parts, body, 2u);
  Quad l_low = PC_GATHER(velocity_parts, body, 3u);
  TwoSum p = pc_two_sum(place.v, pc_add(place_low.v, pc_ld3_tree(PC_PASS n, SMOOTH_WAY_SUM)));
  place.v = p.sum;
  place_low.v = pc_snap3(p.low);
  Quaternion q = pc_quaternion(turned.v, turned.s);
  Turn turn = pc_turn(pc_ld3_tree(PC_PASS n, SMOOTH_TURN));
  Turned next = pc_turned(q, turned_low, pc_quaternion_mul(pc_quaternion(turn.q.v, turn.fall), q));
  precise Real half_h = PC_INFO(h) * PC_REAL(0.5);
  Kick kick = pc_smooth_kick(PC_PASS n, linear.s, PC_INFO(h));
  Vec3 u_half = pc_snap3(pc_madd(kick.u, pc_ld3_tree(PC_PASS n, SMOOTH_V_SUM), half_h));
  Vec3 l_half = pc_snap3(pc_madd(kick.l, pc_ld3_tree(PC_PASS n, SMOOTH_L_SUM), half_h));
  TwoSum u = pc_two_sum(pc_ld3_tree(PC_PASS n, SMOOTH_V), pc_negate(u_half));
  TwoSum l = pc_two_sum(pc_ld3_tree(PC_PASS n, SMOOTH_L), pc_negate(l_half));
  linear.v = pc_snap3(u.sum);
  u_low.v = pc_snap3(pc_add(u.low, pc_ld3_tree(PC_PASS n, SMOOTH_V_LOW)));
  l_low.v = pc_snap3(pc_add(l.low, pc_ld3_tree(PC_PASS n, SMOOTH_L_LOW)));
  PC_SCATTER_IF(moves, pose, body, 0u, place);
  PC_SCATTER_IF(moves, pose, body, 1u, next.q);
  PC_SCATTER_IF(moves, pose, body, 2u, place_low);
  PC_SCATTER_IF(moves, pose, body, 3u, next.low);
  PC_SCATTER_IF(moves, motion, body, 0u, linear);
  PC_SCATTER_IF(moves, motion, body, 1u, pc_quad(pc_snap3(l.sum), PC_REAL(0.0)));
  PC_SCATTER_IF(moves, velocity_parts, body, 0u, pc_quad(u_half, PC_REAL(0.0)));
  PC_SCATTER_IF(moves, velocity_parts, body, 1u, pc_quad(l_half, PC_REAL(0.0)));
  PC_SCATTER_IF(moves, velocity_parts, body, 2u, u_low);
  PC_SCATTER_IF(moves, velocity_parts, body, 3u, l_low);
}
// What its pin does at the end, as an impulse of the sub-step.
PC_FN void pc_smooth_remember(PC_IO Tree t, Slot n, uint k) {
  Real flip = pc_select(PC_IS(pc_is_flipped(PC_PASS t, k)), PC_REAL(-1.0), PC_REAL(1.0));
  Index joint = PC_ENDS(tree_ends, n, 1u);
  precise Vec3 pin = pc_ld3_tree(PC_PASS n, TREE_PIN) * flip * PC_LD(tree_rows, n, TREE_TOTAL) * PC_INFO(h);
  PC_SCATTER(joint_impulse, joint, 0u, pc_quad(pc_snap3(pin), PC_REAL(0.0)));
  PC_SCATTER(joint_impulse, joint, 1u, pc_quad(pc_zero3(), PC_REAL(0.0)));
}

// Before the sweep of a pass: its factor and what the sweep is to undo; 1 where it is to undo anything. Pass 0 brings
// the velocities onto the pins, 1 to 4 are the four stages. `from`: the first node that moves by itself.
PC_FN Real pc_smooth_pass(PC_IO Slot m, Tree t, uint from, uint pass) {
  if (pass > 1u) PC_NODES(k, from, t) pc_smooth_turn(PC_PASS PC_NODE(m, t.first + k));
  PC_MEET;
  if (pass != 1u) {  // the first stage is where the pass before it was
    PC_NODES(k, 1u, t) pc_smooth_arms(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
    pc_factor(PC_PASS m, t, true);
  }
  if (pass == 0u) return pc_smooth_off_pins(PC_PASS m, t);
  PC_NODES(k, from, t) pc_smooth_load(PC_PASS PC_NODE(m, t.first + k));
  PC_NODES(k, 1u, t) pc_smooth_open(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
  return PC_REAL(1.0);
}
// After a stage's sweep: what all nodes gain, with the weights of Runge and Kutta.
PC_FN void pc_smooth_stage(PC_IO Slot m, Tree t, uint from, uint pass) {
  Real h = PC_INFO(h);
  precise Real half_h = h * PC_REAL(0.5);
  Real weight = PC_REAL(1.0);
  Real way = PC_REAL(1.0);
  Real next = half_h;
  if (pass == 2u || pass == 3u) weight = PC_REAL(2.0);
  if (pass == 3u) next = h;
  if (pass == 4u) way = PC_REAL(0.0);
  PC_NODES(k, from, t) pc_smooth_gain(PC_PASS PC_NODE(m, t.first + k), weight, way, next);
}
// The root's way, and its velocity at the end.
PC_FN void pc_smooth_finish_root(PC_IO Slot root) {
  Real h = PC_INFO(h);
  precise Real sixth = h * PC_SIXTH;
  Vec3 v = pc_ld3_tree(PC_PASS root, SMOOTH_V);
  precise Vec3 gone = (v + pc_ld3_tree(PC_PASS root, SMOOTH_WAY_SUM) * sixth) * h;
  pc_st3_tree(PC_PASS root, SMOOTH_WAY_SUM, gone);
  pc_smooth_add(PC_PASS root, SMOOTH_V, SMOOTH_V_LOW, pc_scale(pc_ld3_tree(PC_PASS root, SMOOTH_V_SUM), sixth));
}
// After the stages: all nodes at the end of the sub-step.
PC_FN void pc_smooth_end(PC_IO Slot m, Tree t, uint from) {
  PC_ONE pc_smooth_finish_root(PC_PASS PC_NODE(m, t.first));
  PC_NODES(k, from, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_smooth_finish(PC_PASS n);
    Index body = PC_ENDS(tree_ends, n, 0u);
    Quad turned = PC_GATHER(pose, body, 1u);
    Turn turn = pc_turn(pc_ld3_tree(PC_PASS n, SMOOTH_TURN));
    pc_smooth_face(PC_PASS n, pc_quaternion_mul(turn.q, pc_quaternion(turned.v, turned.s)));
  }
  PC_MEET;
  PC_DOWN(k, 1u, t) pc_smooth_follow(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
  PC_NODES(k, 1u, t) {
    pc_smooth_pin(PC_PASS PC_NODE(m, t.first + k));
    PC_THEN(PC_CHILDREN(k, t))
    pc_smooth_pin_parent(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
  }
  PC_MEET;
  PC_NODES(k, from, t) pc_smooth_store(PC_PASS PC_NODE(m, t.first + k));
  PC_NODES(k, 1u, t) pc_smooth_remember(PC_PASS t, PC_NODE(m, t.first + k), k);
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  PC_NODES(k, 0u, t) pc_smooth_start(PC_PASS PC_NODE(m, t.first + k));
  uint from = 1u;
  if (PC_ANY(pc_smooth_moves(PC_PASS PC_NODE(m, t.first)))) from = 0u;  // lint: allow (what stands stays as it is)
  for (uint pass = 0u; pass < 5u; pass++) {
    Mask acts = pc_smooth_pass(PC_PASS m, t, from, pass) > PC_REAL(0.5);
    if (PC_ANY(acts)) {  // lint: allow (as in pc_smooth_off_pins)
      pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PIN, PC_REAL(0.0));
    }
    if (pass > 0u) {
      pc_smooth_stage(PC_PASS m, t, from, pass);
      continue;
    }
    if (PC_ANY(acts)) {  // lint: allow (as above)
      PC_NODES(k, 0u, t) pc_smooth_onto_pins(PC_PASS PC_NODE(m, t.first + k));
    }
    PC_NODES(k, 0u, t) pc_smooth_begin(PC_PASS PC_NODE(m, t.first + k));
  }
  pc_smooth_end(PC_PASS m, t, from);
}
