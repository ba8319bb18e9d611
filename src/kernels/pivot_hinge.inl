// How a hinge turns about its pin (pivot_turn.inl): its axis stays where it is, so by one angle, under the torque of a
// weight that goes round. What it gains of the momentum about the axis is summed by itself, and so is the angle: of
// either no digit is lost between the kicks.
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
// `sense`: +1 where the slack grows with the angle, else -1; `back`: restitution.
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
