// Before `advance`: a body that one pin alone holds to a fixed body turns about that pin with its inertia there. A
// constraint solved once a sub-step would let it turn about its centre of mass meanwhile: a fast top then nutates five
// times too fast between kicks (docs/joint-trees.md). What acts on it from a distance (gravity, forces, torques) acts
// along the way, by the splitting of fourth order of S. Blanes and P. Moan, J. Comput. Appl. Math. 142 (2002), table 2,
// order 4, s = 6, kicks first.
//
// Stored velocities are half a kick behind the pose, as everywhere, but u is w x r at the pose's time and not the mean
// of the sub-step: L + m r x u is then the momentum about the pin at any time, whatever impulses came, and what
// rounding loses of it stays in the low part. `advance` is given nothing to do; pivot_settle brings the velocities
// back.
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
// The same with what the sum rounds away: it is formed anew in every sub-step, and what it lost would be lost a million
// times.
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
// The frame is that of the principal axes about the pin; what the turns change of it is summed, and brought to its
// length once.
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
// The same of a hinge, whose axis stays where it is: one angle, and the torque of a weight that goes round. What it
// gains of the momentum about the axis is summed by itself, and so is the angle: of either no digit is lost between the
// kicks.
struct Hinge {
  Vec3 axis;
  Real steady;
  Real beside;
  Real under;
  Real momentum;
};
struct Way {
  Real angle;
  Real gained;
};
PC_FN Hinge pc_hinge(Pivot p, Motion start) {
  Quaternion q = pc_facing(start);
  Hinge g;
  g.axis = pc_hinge_axis(p, q);
  Vec3 side = pc_cross(g.axis, pc_from_pin(p, q));
  g.steady = pc_dot(g.axis, p.torque);
  g.beside = pc_dot(p.weight, side);
  g.under = pc_dot(pc_cross(g.axis, p.weight), side);
  precise Real momentum = pc_dot(g.axis, start.l) + pc_dot(g.axis, start.low);
  g.momentum = momentum;
  return g;
}
PC_FN Way pc_hinge_way(Pivot p, Hinge g, Real from, Real momentum, Real h) {
  Real gained = PC_REAL(0.0);
  Real angle = from;
  for (uint i = 0u; i < 7u; i++) {
    Shares s = pc_shares(i);
    precise Real kick = s.kick * h;
    precise Real time = s.turn * h;
    SinCos at = pc_sincos(angle);
    precise Real torque = g.steady + g.beside * at.cosine - g.under * at.sine;
    precise Real sum = gained + torque * kick;
    gained = sum;
    precise Real further = angle + (momentum + gained) * p.inverse.x * time;
    if (i < 6u) angle = further;
  }
  Way w;
  w.angle = angle;
  w.gained = gained;
  return w;
}
PC_FN Motion pc_hinged(Hinge g, Motion start, Way way) {
  Quaternion q = pc_facing(start);
  Turn turn = pc_axis_turn(g.axis, way.angle);
  Motion m = pc_kick(start, g.axis, way.gained);
  m.at = pc_turned(q, start.at.low, pc_quaternion_mul(pc_quaternion(turn.q.v, turn.fall), q));
  return m;
}

// A hinge's limit that it comes to within the sub-step stops it, or throws it back, at the instant at which it is there
// (tree_prepare keeps its row from the solve until then).
// Sense: +1 where the slack grows with the angle, else -1; back: restitution.
struct Stop {
  Real slack;
  Real sense;
  Real back;
};
struct Stopped {
  Way way;
  Real impulse;
};
PC_FN Stop pc_stop(PC_IO Slot n, Vec3 axis) {
  Mask waits = pc_and(PC_LD(tree_rows, n, TREE_KIND) < PC_REAL(0.5), pc_nonzero(PC_LD(tree_rows, n, TREE_SIGN)));
  Real one = PC_REAL(1.0);
  Real zero = PC_REAL(0.0);
  Stop s;
  s.slack = pc_select(waits, PC_LD(tree_rows, n, TREE_SLACK), PC_FAR);
  s.sense = pc_select(pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS), axis) > zero, one, -one);
  s.back = pc_select(pc_throws_back(PC_PASS n), PC_LD(tree_rows, n, TREE_REBOUND), zero);
  return s;
}
PC_FN Real pc_left_of(Stop s, Real angle) {
  precise Real left = s.slack + s.sense * angle;
  return left;
}
PC_FN Stopped pc_stopped(PC_IO Pivot p, Hinge g, Stop s, Way beyond, Real h) {
  precise Real share = s.slack - pc_left_of(s, beyond.angle);
  precise Real when = pc_div(s.slack, share) * h;
  Way there = beyond;
  for (uint i = 0u; i < 5u; i++) {  // Newton's method: the rate hardly changes on the way
    there = pc_hinge_way(p, g, PC_REAL(0.0), g.momentum, when);
    if (i == 4u) break;
    precise Real rate = (g.momentum + there.gained) * p.inverse.x * -s.sense;
    precise Real later = when + pc_left_of(s, there.angle) * pc_inverse_or_zero(rate);
    when = pc_clamp(later, PC_REAL(0.0), h);
  }
  precise Real limit = s.slack * -s.sense;
  precise Real arriving = g.momentum + there.gained;
  precise Real approach = s.sense * arriving * -p.inverse.x;
  precise Real thrown = arriving * -s.back;
  Real leaving = pc_select(approach > PC_INFO(restitution_threshold), thrown, PC_REAL(0.0));
  precise Real rest = h - when;
  Way after = pc_hinge_way(p, g, limit, leaving, rest);
  Mask held = pc_left_of(s, after.angle) < PC_REAL(0.0);
  precise Real end = leaving + after.gained;
  precise Real gained = pc_select(held, PC_REAL(0.0), end) - g.momentum;
  precise Real impulse = (gained - there.gained - after.gained) * s.sense;
  Stopped o;
  o.way.angle = pc_select(held, limit, after.angle);
  o.way.gained = gained;
  o.impulse = pc_max(impulse, PC_REAL(0.0));
  return o;
}
PC_FN Stopped pc_hinge_on(PC_IO Slot n, Pivot p, Hinge g, Real h) {
  Stopped o;
  o.way = pc_hinge_way(p, g, PC_REAL(0.0), g.momentum, h);
  o.impulse = PC_REAL(0.0);
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return o;  // lint: allow (no limit otherwise)
  Stop s = pc_stop(PC_PASS n, g.axis);
  Mask meets = pc_left_of(s, o.way.angle) < PC_REAL(0.0);
  if (!PC_ANY(meets)) return o;  // lint: allow (selected below)
  Stopped there = pc_stopped(PC_PASS p, g, s, o.way, h);
  o.way.angle = pc_select(meets, there.way.angle, o.way.angle);
  o.way.gained = pc_select(meets, there.way.gained, o.way.gained);
  o.impulse = pc_select(meets, there.impulse, o.impulse);
  return o;
}
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

// How far a hinge is turned out of its locked angles, as a rotation vector that turns it back; of it what may be closed
// now.
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

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Slot n = PC_NODE(m, t.first + 1u);
  if (!PC_ANY(PC_LD(tree_rows, n, TREE_PIVOT) > PC_REAL(0.5))) {  // lint: allow (the same for all lanes of a block)
    return;
  }
  Index body = PC_ENDS(tree_ends, n, 0u);
  Index joint = PC_ENDS(tree_ends, n, 1u);
  Real h = PC_INFO(h);
  precise Real half_h = h * PC_REAL(0.5);
  Quad linear = PC_GATHER(motion, body, 0u);
  Quad angular = PC_GATHER(motion, body, 1u);
  Quad place = PC_GATHER(pose, body, 0u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Quad place_low = PC_GATHER(pose, body, 2u);
  Quad turned_low = PC_GATHER(pose, body, 3u);
  Quad u_before = PC_GATHER(velocity_parts, body, 0u);
  Quad l_before = PC_GATHER(velocity_parts, body, 1u);
  Quad u_low = PC_GATHER(velocity_parts, body, 2u);
  Quad l_low = PC_GATHER(velocity_parts, body, 3u);
  Pivot p = pc_pivot(PC_PASS n, body, joint, linear.s);

  Quaternion q = pc_quaternion(turned.v, turned.s);
  Vec3 r = pc_from_pin(p, q);
  Mask swings = pc_swings(p);
  Mask hinged = pc_select(swings, PC_REAL(0.0), PC_REAL(1.0)) > PC_REAL(0.5);
  Vec3 axis = pc_hinge_axis(p, q);
  Vec3 all = pc_torque(p, r);
  Vec3 torque = pc_select3(swings, all, pc_along(axis, all));
  // the momentum of before to the bit, and beside it what was given since: their sum as one real would round anew each
  // time
  Vec3 given = pc_about_pin(p, r, pc_sub(linear.v, u_before.v), pc_sub(angular.v, l_before.v));
  TwoSum before = pc_sum_about_pin(p, r, u_before.v, l_before.v);
  Motion start;
  start.l = before.sum;
  start.low = pc_add(pc_add(given, pc_about_pin(p, r, u_low.v, l_low.v)), before.low);
  Turn straight = pc_turn(pc_add(pc_straightening(PC_PASS n), pc_pushed_turn(PC_PASS n, p, q, r)));
  start.at = pc_turned(q, turned_low, pc_quaternion_mul(pc_quaternion(straight.q.v, straight.fall), q));
  // in phase with the pose: it has had a whole kick and was half a one behind
  precise Real back = -half_h;
  start = pc_kick(start, torque, back);
  Motion next = start;
  Real pressed = PC_REAL(0.0);
  if (PC_ANY(swings)) next = pc_swing_on(p, start, h);  // lint: allow (selected below)
  if (PC_ANY(hinged)) {                                 // lint: allow (other lanes keep what they have)
    Hinge g = pc_hinge(p, start);
    Stopped on = pc_hinge_on(PC_PASS n, p, g, h);
    next = pc_select_motion(swings, next, pc_hinged(g, start, on.way));
    pressed = pc_select(swings, pressed, on.impulse);
  }
  Quaternion q_next = pc_facing(next);
  Vec3 r_next = pc_from_pin(p, q_next);
  Vec3 all_next = pc_torque(p, r_next);
  Vec3 torque_next = pc_select3(swings, all_next, pc_along(axis, all_next));
  next = pc_kick(next, torque_next, back);

  // the way about the pin, and of a gap what may be closed
  Vec3 gap = pc_ld3_tree(PC_PASS n, TREE_GAP);
  Real closed = pc_share_closed(PC_PASS gap);
  precise Vec3 step = (r_next - r) - gap * closed;
  TwoSum there = pc_two_sum(place.v, pc_add(place_low.v, step));
  Quaternion rotation = pc_quaternion_mul(q_next, pc_conjugate(q));
  Real two = pc_select(rotation.w < PC_REAL(0.0), PC_REAL(-2.0), PC_REAL(2.0));
  precise Real square = pc_four_times(pc_dot(rotation.v, rotation.v));

  Swing now = pc_swing_of(p, q_next, r_next, next.l);
  TwoSum kept = pc_sum_about_pin(p, r_next, now.u, now.l);
  precise Vec3 lost = ((next.l - kept.sum) - kept.low) + next.low;
  Vec3 low = pc_select3(swings, lost, pc_along(axis, lost));
  pc_add_impulse(PC_PASS n, pc_scale(pc_sub(now.u, linear.v), p.mass), pc_sub(now.l, angular.v),
                 pc_scale(pc_add(r, r_next), PC_REAL(0.5)), pressed);
  // the velocities that are read are half a kick ahead: of what acts from a distance that of now, of the rest half of
  // the last
  Vec3 change = pc_sub(torque_next, torque);
  Swing kick = pc_swing_of(p, q_next, r_next, pc_madd(given, change, h));

  Mask exists = linear.s > PC_REAL(0.0);
  Vec3 zero = pc_zero3();
  Real none = PC_REAL(0.0);
  pc_st6_tree(PC_PASS n, TREE_X, pc_six(now.u, now.l));
  pc_st6_tree(PC_PASS n, TREE_F, pc_six(step, pc_scale(rotation.v, two)));
  PC_ST(tree_rows, n, TREE_C, square);
  PC_SCATTER_IF(exists, motion, body, 0u, pc_quad(zero, linear.s));
  PC_SCATTER_IF(exists, motion, body, 1u, pc_quad(zero, angular.s));
  PC_SCATTER_IF(exists, pose, body, 0u, pc_quad(there.sum, place.s));
  PC_SCATTER_IF(exists, pose, body, 1u, next.at.q);
  PC_SCATTER_IF(exists, pose, body, 2u, pc_quad(pc_snap3(there.low), place_low.s));
  PC_SCATTER_IF(exists, pose, body, 3u, next.at.low);
  PC_SCATTER_IF(exists, velocity_parts, body, 0u, pc_quad(pc_snap3(pc_sub(now.u, kick.u)), u_before.s));
  PC_SCATTER_IF(exists, velocity_parts, body, 1u, pc_quad(pc_snap3(pc_sub(now.l, kick.l)), none));
  PC_SCATTER_IF(exists, velocity_parts, body, 2u, pc_quad(zero, none));
  PC_SCATTER_IF(exists, velocity_parts, body, 3u, pc_quad(pc_snap3(low), l_low.s));
}
