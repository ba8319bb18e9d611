// Before `advance`: a body that one pin alone holds to a fixed body turns about that pin with its inertia there. A
// constraint solved once a sub-step would let it turn about its centre of mass meanwhile: a fast top then nutates five
// times too fast between kicks (docs/joint-trees.md). What acts on it from a distance (gravity, forces, torques) acts
// along the way, by the splitting of fourth order of S. Blanes and P. Moan, J. Comput. Appl. Math. 142 (2002), table 2,
// order 4, s = 6, kicks first.
//
// Stored velocities are half a kick behind the pose, as everywhere, but u is w x r at the pose's time and not the mean
// of the sub-step: L + m r x u is then the momentum about the pin at any time, whatever impulses came, and what
// rounding loses of it stays in the low part. `advance` is given nothing to do;
// pivot_settle brings the velocities back.
#define PC_NO_PARENTS
#include "tree_rows.inl"
#undef PC_NO_PARENTS
#include "tree_store.inl"
#include "free_rotation.inl"
#include "turned.inl"

struct Pivot {
  Vec3 inverse;
  Real middle;
  Quaternion axes;
  Vec3 moments;
  Vec3 arm;
  Real mass;
  Vec3 weight;
  Vec3 torque;
};
// Velocities of a body at q from its momentum about the pin; r from the pin to its centre.
struct Swing {
  Vec3 u;
  Vec3 l;
};
PC_FN Swing pc_swing_of(Pivot p, Quaternion q, Vec3 r, Vec3 momentum) {
  Vec3 w = pc_sym_mul(pc_world_inertia(pc_quaternion_mul(q, p.axes), p.inverse), momentum);
  Swing s;
  s.u = pc_cross(w, r);
  s.l = pc_sym_mul(pc_world_inertia(q, p.moments), w);
  return s;
}
PC_FN Vec3 pc_about_pin(Pivot p, Vec3 r, Vec3 u, Vec3 l) {
  Vec3 orbit = pc_cross(r, u);
  return pc_madd(l, orbit, p.mass);
}
// The same with what the sum rounds away: it is formed anew in every sub-step,
// and what it lost would be lost a million times.
PC_FN TwoSum pc_sum_about_pin(Pivot p, Vec3 r, Vec3 u, Vec3 l) {
  return pc_two_sum(pc_scale(pc_cross(r, u), p.mass), l);
}
PC_FN Vec3 pc_from_pin(Pivot p, Quaternion q) { return pc_negate(pc_rotate(q, p.arm)); }
PC_FN Vec3 pc_torque(Pivot p, Vec3 r) { return pc_add(p.torque, pc_cross(r, p.weight)); }
// A hinge turns about one axis alone, x of the pivot's.
PC_FN Mask pc_swings(Pivot p) { return pc_max(p.inverse.y, p.inverse.z) > PC_REAL(0.0); }
PC_FN Vec3 pc_hinge_axis(Pivot p, Quaternion q) {
  return pc_rotate(pc_quaternion_mul(q, p.axes), Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0)));
}
PC_FN Vec3 pc_along(Vec3 axis, Vec3 v) { return pc_scale(axis, pc_dot(axis, v)); }
PC_FN Vec3 pc_inverse3(Vec3 v) {
  return Vec3(pc_inverse_or_zero(v.x), pc_inverse_or_zero(v.y), pc_inverse_or_zero(v.z));
}

#define PC_KICK_0 PC_REAL(0.0792036964311957)
#define PC_KICK_1 PC_REAL(0.353172906049774)
#define PC_KICK_2 PC_REAL(-0.0420650803577195)
#define PC_KICK_3 PC_REAL(0.2193769557534996)
#define PC_TURN_0 PC_REAL(0.209515106613362)
#define PC_TURN_1 PC_REAL(-0.143851773179818)
#define PC_TURN_2 PC_REAL(0.434336666566456)
// Shares of the sub-step: kicks a0 to a6, turns b0 to b5 between them.
struct Shares {
  Real kick;
  Real turn;
};
PC_FN Shares pc_shares(uint i) {
  Shares s;
  s.kick = PC_KICK_0;
  s.turn = PC_TURN_0;
  if (i == 1u || i == 5u) s.kick = PC_KICK_1;
  if (i == 2u || i == 4u) s.kick = PC_KICK_2;
  if (i == 3u) s.kick = PC_KICK_3;
  if (i == 1u || i == 4u) s.turn = PC_TURN_1;
  if (i == 2u || i == 3u) s.turn = PC_TURN_2;
  return s;
}
// Orientation and momentum about the pin, as sums of two reals, and the turn so far.
struct Motion {
  Turned at;
  Vec3 l;
  Vec3 low;
};
PC_FN Motion pc_kick(Motion m, Vec3 torque, Real time) {
  TwoSum sum = pc_two_sum(m.l, pc_madd(m.low, torque, time));
  Motion o = m;
  o.l = sum.sum;
  o.low = sum.low;
  return o;
}
PC_FN Quaternion pc_facing(Motion m) { return pc_quaternion(m.at.q.v, m.at.q.s); }
// The frame is that of the principal axes about the pin; what the turns change of it is summed,
// and brought to its length once.
PC_FN Motion pc_swing_on(Pivot p, Motion start, Real h) {
  Motion m = start;
  Quad about = pc_quad(p.inverse, p.middle);
  Quaternion back = pc_conjugate(p.axes);
  Vec3 arm = pc_rotate(back, p.arm);
  Quaternion q = pc_facing(start);
  Quaternion first = pc_quaternion_mul(q, p.axes);
  Quaternion frame = first;
  Quaternion change = pc_quaternion(pc_zero3(), PC_REAL(0.0));
  for (uint i = 0u; i < 7u; i++) {
    Shares s = pc_shares(i);
    precise Real kick = s.kick * h;
    precise Real time = s.turn * h;
    m = pc_kick(m, pc_torque(p, pc_negate(pc_rotate(frame, arm))), kick);
    if (i == 6u) break;
    Quaternion turn = pc_free_rotation(frame, m.l, about, time);
    precise Vec3 v = change.v + turn.v;
    precise Real w = change.w + turn.w;
    change = pc_quaternion(v, w);
    precise Vec3 now_v = first.v + v;
    precise Real now_w = first.w + w;
    frame = pc_quaternion(now_v, now_w);
  }
  m.at = pc_righted(pc_turned(q, start.at.low, pc_quaternion_mul(change, back)));
  return m;
}
#include "pivot_hinge.inl"
PC_FN Motion pc_select_motion(Mask m, Motion a, Motion b) {
  Motion o;
  o.at.q = pc_quad(pc_select3(m, a.at.q.v, b.at.q.v), pc_select(m, a.at.q.s, b.at.q.s));
  o.at.low = pc_quad(pc_select3(m, a.at.low.v, b.at.low.v), pc_select(m, a.at.low.s, b.at.low.s));
  o.l = pc_select3(m, a.l, b.l);
  o.low = pc_select3(m, a.low, b.low);
  return o;
}

// Share of a gap that is closed in a sub-step, at joint_push_speed at most.
PC_FN Real pc_share_closed(PC_IO Vec3 gap) {
  Real size = pc_length(gap);
  precise Real most = PC_INFO(joint_push_speed) * PC_INFO(h);
  return pc_share_within(size, most);
}
PC_FN Pivot pc_pivot(PC_IO Slot n, Index body, Index joint, Real inverse_mass) {
  Quad about = PC_GATHER(joint_pivot, joint, 0u);
  Quad axes = PC_GATHER(joint_pivot, joint, 1u);
  Quad arm = PC_GATHER(joint_pivot, joint, 2u);
  Quad push = PC_GATHER(force, body, 0u);
  Quad twist = PC_GATHER(force, body, 1u);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 acceleration = pc_madd(gravity, push.v, inverse_mass);
  Pivot p;
  p.inverse = about.v;
  p.middle = about.s;
  p.axes = pc_quaternion(axes.v, axes.s);
  p.moments = pc_inverse3(pc_ld3_tree(PC_PASS n, TREE_MOMENTS));
  p.arm = arm.v;
  p.mass = arm.s;
  p.weight = pc_scale(acceleration, arm.s);
  p.torque = twist.v;
  return p;
}

// How far a hinge is turned out of its locked angles, as a rotation vector that turns it back;
// of it what may be closed now.
PC_FN Vec3 pc_straightening(PC_IO Slot n) {
  Vec3 tilt = pc_zero3();
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return tilt;  // lint: allow (zeros otherwise)
  for (uint i = 0u; i < 3u; i++) {
    Real slack =
        pc_select(PC_LD(tree_rows, n, TREE_KIND + i) > PC_REAL(1.0), PC_LD(tree_rows, n, TREE_SLACK + i), PC_REAL(0.0));
    tilt = pc_madd(tilt, pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), slack);
  }
  return pc_negate(pc_scale(tilt, pc_share_closed(PC_PASS tilt)));
}

// How far contacts push it about its pin (tree_flush), as a rotation vector.
PC_FN Vec3 pc_pushed_turn(PC_IO Slot n, Pivot p, Quaternion q, Vec3 r) {
  Vec3 momentum = pc_about_pin(p, r, pc_ld3_tree(PC_PASS n, TREE_PUSH_SPEED),
                               pc_scale(pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN), PC_LD(tree_rows, n, TREE_TOTAL)));
  return pc_scale(pc_sym_mul(pc_world_inertia(pc_quaternion_mul(q, p.axes), p.inverse), momentum), PC_INFO(h));
}

// What the joint gave to the velocities meanwhile, on top of what tree_solve found, where that ran: a push at the pin,
// couples about locked axes, and what a limit pressed. r: from the pin to the centre.
PC_FN void pc_add_impulse(PC_IO Slot n, Vec3 push, Vec3 turn, Vec3 r, Real pressed) {
  Real share = pc_inverse_or_zero(PC_LD(tree_rows, n, TREE_TOTAL));
  pc_st3_tree(PC_PASS n, TREE_PIN, pc_madd(pc_ld3_tree(PC_PASS n, TREE_PIN), push, share));
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return;  // lint: allow (zeros otherwise)
  precise Real limit = PC_LD(tree_rows, n, TREE_LIMIT) + pressed * share;
  PC_ST(tree_rows, n, TREE_LIMIT, limit);
  Vec3 couple = pc_add(turn, pc_cross(r, push));
  for (uint i = 0u; i < 3u; i++) {
    Real given = pc_select(PC_LD(tree_rows, n, TREE_KIND + i) > PC_REAL(1.0), share, PC_REAL(0.0));
    precise Real impulse =
        PC_LD(tree_rows, n, TREE_LIMIT + i) + pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), couple) * given;
    PC_ST(tree_rows, n, TREE_LIMIT + i, impulse);
  }
}

// Of the torque about the pin what turns it.
PC_FN Vec3 pc_turning_torque(Pivot p, Vec3 r, Vec3 axis) {
  Vec3 all = pc_torque(p, r);
  return pc_select3(pc_swings(p), all, pc_along(axis, all));
}
// The momentum about the pin that was given since the velocities were stored.
PC_FN Vec3 pc_given(PC_IO Index body, Pivot p, Vec3 r) {
  Vec3 u = pc_sub(PC_GATHER(motion, body, 0u).v, PC_GATHER(velocity_parts, body, 0u).v);
  Vec3 l = pc_sub(PC_GATHER(motion, body, 1u).v, PC_GATHER(velocity_parts, body, 1u).v);
  return pc_about_pin(p, r, u, l);
}
// The orientation, straightened, and the momentum: that of before to the bit, and beside it what was given since, as
// their sum as one real would round anew each time.
PC_FN Motion pc_pivot_start(PC_IO Slot n, Index body, Pivot p, Vec3 r, Vec3 given) {
  Quad turned = PC_GATHER(pose, body, 1u);
  Quaternion q = pc_quaternion(turned.v, turned.s);
  Vec3 u_low = PC_GATHER(velocity_parts, body, 2u).v;
  Vec3 l_low = PC_GATHER(velocity_parts, body, 3u).v;
  TwoSum before = pc_sum_about_pin(p, r, PC_GATHER(velocity_parts, body, 0u).v, PC_GATHER(velocity_parts, body, 1u).v);
  Motion start;
  start.l = before.sum;
  start.low = pc_add(pc_add(given, pc_about_pin(p, r, u_low, l_low)), before.low);
  Turn straight = pc_turn(pc_add(pc_straightening(PC_PASS n), pc_pushed_turn(PC_PASS n, p, q, r)));
  Quaternion change = pc_quaternion_mul(pc_quaternion(straight.q.v, straight.fall), q);
  start.at = pc_turned(q, PC_GATHER(pose, body, 3u), change);
  return start;
}
// The sub-step; `pressed`: what a limit pressed in it.
PC_FN Motion pc_pivot_on(PC_IO Slot n, Pivot p, Motion start, PC_INOUT(Real) pressed) {
  Real h = PC_INFO(h);
  Mask swings = pc_swings(p);
  Mask hinged = pc_select(swings, PC_REAL(0.0), PC_REAL(1.0)) > PC_REAL(0.5);
  Motion next = start;
  if (PC_ANY(swings)) next = pc_swing_on(p, start, h);  // lint: allow (selected below)
  if (PC_ANY(hinged)) {                                 // lint: allow (other lanes keep what they have)
    Hinge g = pc_hinge(p, start);
    Stopped on = pc_hinge_on(PC_PASS n, p, g, h);
    next = pc_select_motion(swings, next, pc_hinged(g, start, on.way));
    pressed = pc_select(swings, pressed, on.impulse);
  }
  return next;
}
// Takes the body the way about the pin, from r to r_next, and of a gap what may be closed.
PC_FN void pc_store_way(PC_IO Slot n, Index body, Vec3 r, Vec3 r_next, Turned next) {
  Quad place = PC_GATHER(pose, body, 0u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Quad place_low = PC_GATHER(pose, body, 2u);
  Vec3 gap = pc_ld3_tree(PC_PASS n, TREE_GAP);
  Real closed = pc_share_closed(PC_PASS gap);
  precise Vec3 step = (r_next - r) - gap * closed;
  TwoSum there = pc_two_sum(place.v, pc_add(place_low.v, step));
  Quaternion rotation =
      pc_quaternion_mul(pc_quaternion(next.q.v, next.q.s), pc_conjugate(pc_quaternion(turned.v, turned.s)));
  Real two = pc_select(rotation.w < PC_REAL(0.0), PC_REAL(-2.0), PC_REAL(2.0));
  precise Real square = pc_four_times(pc_dot(rotation.v, rotation.v));
  Mask exists = PC_GATHER(motion, body, 0u).s > PC_REAL(0.0);
  pc_st6_tree(PC_PASS n, TREE_F, pc_six(step, pc_scale(rotation.v, two)));
  PC_ST(tree_rows, n, TREE_C, square);
  PC_SCATTER_IF(exists, pose, body, 0u, pc_quad(there.sum, place.s));
  PC_SCATTER_IF(exists, pose, body, 1u, next.q);
  PC_SCATTER_IF(exists, pose, body, 2u, pc_quad(pc_snap3(there.low), place_low.s));
  PC_SCATTER_IF(exists, pose, body, 3u, next.low);
}
// The velocities `now`, and beside them what their sum about the pin rounds away (`low`). Those that are read are half
// a kick ahead, by `kick`.
PC_FN void pc_store_swing(PC_IO Slot n, Index body, Swing now, Swing kick, Vec3 low) {
  Quad linear = PC_GATHER(motion, body, 0u);
  Quad angular = PC_GATHER(motion, body, 1u);
  Quad u_before = PC_GATHER(velocity_parts, body, 0u);
  Quad l_low = PC_GATHER(velocity_parts, body, 3u);
  Mask exists = linear.s > PC_REAL(0.0);
  Vec3 zero = pc_zero3();
  Real none = PC_REAL(0.0);
  pc_st6_tree(PC_PASS n, TREE_X, pc_six(now.u, now.l));
  PC_SCATTER_IF(exists, motion, body, 0u, pc_quad(zero, linear.s));
  PC_SCATTER_IF(exists, motion, body, 1u, pc_quad(zero, angular.s));
  PC_SCATTER_IF(exists, velocity_parts, body, 0u, pc_quad(pc_snap3(pc_sub(now.u, kick.u)), u_before.s));
  PC_SCATTER_IF(exists, velocity_parts, body, 1u, pc_quad(pc_snap3(pc_sub(now.l, kick.l)), none));
  PC_SCATTER_IF(exists, velocity_parts, body, 2u, pc_quad(zero, none));
  PC_SCATTER_IF(exists, velocity_parts, body, 3u, pc_quad(pc_snap3(low), l_low.s));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Slot n = PC_NODE(m, t.first + 1u);
  if (!PC_ANY(PC_LD(tree_rows, n, TREE_PIVOT) > PC_REAL(0.5))) {  // lint: allow (the same for all lanes of a block)
    return;
  }
  Index body = PC_ENDS(tree_ends, n, 0u);
  Real h = PC_INFO(h);
  Quad linear = PC_GATHER(motion, body, 0u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Quaternion q = pc_quaternion(turned.v, turned.s);
  Pivot p = pc_pivot(PC_PASS n, body, PC_ENDS(tree_ends, n, 1u), linear.s);
  Vec3 r = pc_from_pin(p, q);
  Vec3 axis = pc_hinge_axis(p, q);
  Vec3 torque = pc_turning_torque(p, r, axis);
  Vec3 given = pc_given(PC_PASS body, p, r);
  precise Real half_h = h * PC_REAL(0.5);
  // in phase with the pose: it has had a whole kick and was half a one behind
  precise Real back = -half_h;
  Motion start = pc_kick(pc_pivot_start(PC_PASS n, body, p, r, given), torque, back);
  Real pressed = PC_REAL(0.0);
  Motion next = pc_pivot_on(PC_PASS n, p, start, pressed);
  Quaternion q_next = pc_facing(next);
  Vec3 r_next = pc_from_pin(p, q_next);
  Vec3 torque_next = pc_turning_torque(p, r_next, axis);
  next = pc_kick(next, torque_next, back);

  Swing now = pc_swing_of(p, q_next, r_next, next.l);
  TwoSum kept = pc_sum_about_pin(p, r_next, now.u, now.l);
  precise Vec3 lost = ((next.l - kept.sum) - kept.low) + next.low;
  Vec3 low = pc_select3(pc_swings(p), lost, pc_along(axis, lost));
  pc_add_impulse(PC_PASS n, pc_scale(pc_sub(now.u, linear.v), p.mass), pc_sub(now.l, PC_GATHER(motion, body, 1u).v),
                 pc_scale(pc_add(r, r_next), PC_REAL(0.5)), pressed);
  // of what acts from a distance the velocities that are read have that of now, of the rest half of the last
  Vec3 change = pc_sub(torque_next, torque);
  Swing kick = pc_swing_of(p, q_next, r_next, pc_madd(given, change, h));
  pc_store_way(PC_PASS n, body, r, r_next, next.at);
  pc_store_swing(PC_PASS n, body, now, kick, low);
}
