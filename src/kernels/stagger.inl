// The stored velocity u is half a sub-step behind the position. With F the drag, a the acceleration, phi and phi2
// of F h (1 and 1/2 without drag) and e = e^(-F h), motion between impulses has
//   u = v + h (phi2 - phi) / e (a - F v),   v = u + h (phi - phi2) / phi (a - F u)
// where v is the velocity in phase with the position: then the first sub-step's u' = e u + a h phi is its exact mean
// velocity phi v + a h phi2 (without drag u = v - a h / 2, the half kick; Hairer, Lubich, Wanner, Geometric
// Numerical Integration I.1).
// * A velocity that was just set is in phase.
// * When the sub-step changes from h0 to h: back into phase by h0, out of it by h; and what impulses changed in
//   the last sub-step shifts by (h0 - h) / (2 h0). Where a step is divided into more sub-steps (by_forces), what joints
//   did does not shift unless a contact holds the body: the next solve gives what is due at this pose, and the change
//   of the last sub-step is half a sub-step old.
// * The original's scheme (PC_SEED) knows no phase: p - p_last goes on as it is, also where the sub-step changes.
// By how much the stored velocity changes; `half_change` is half of what the last sub-step changed in it.
#ifdef PC_SEED
// u + half change is the velocity that is read, of which the half change is what a host's new forces set aside
PC_FN Vec3 pc_shift(PC_IO Mask in_phase, Vec3 velocity, Vec3 half_change) {
  Real stretch = pc_div(PC_INFO(h_before), PC_INFO(h));
  precise Real more = stretch - PC_REAL(1.0);
  precise Vec3 whole = velocity + half_change;
  precise Vec3 shift = half_change + whole * more;
  return pc_select3(in_phase, half_change, shift);
}
#elif defined(PC_DRAG)
PC_FN Vec3 pc_shift(PC_IO Mask in_phase, Mask free, Vec3 velocity, Vec3 half_change, Vec3 a, Real drag) {
  Real h = PC_INFO(h);
  Real share = PC_INFO(h_change);
  Mask changes = pc_nonzero(share);
  if (!PC_ANY(pc_or(in_phase, changes))) return pc_zero3();  // lint: allow (other lanes keep what they have)
  Real before = PC_INFO(h_before);
  precise Real x = drag * h;
  precise Real y = drag * before;
  Decay now = pc_decay(x);
  Decay was = pc_decay(y);
  precise Real back_gap = was.phi - was.phi2;
  precise Real back_time = pc_div(back_gap, was.phi) * before;
  precise Vec3 back = (a - velocity * drag) * back_time;
  precise Vec3 phased = velocity + back;
  precise Real gap = now.phi2 - now.phi;
  precise Real time = pc_div(gap, now.e) * h;
  Vec3 v = pc_select3(in_phase, velocity, phased);
  precise Vec3 kick = (a - v * drag) * time;
  precise Vec3 forced = back + kick;
  precise Vec3 shifted = forced + (half_change - back) * share;
  precise Vec3 plain = half_change * share;
  Mask drags = drag > PC_REAL(0.0);
  precise Real half_time = before * share * PC_REAL(0.5);
  // without drag as in a world that has none
  Vec3 by_forces = pc_select3(drags, forced, pc_scale(a, half_time));
  Vec3 shift = pc_select3(drags, shifted, plain);
  return pc_select3(in_phase, kick, pc_select3(changes, pc_select3(free, by_forces, shift), pc_zero3()));
}
#else
PC_FN Vec3 pc_shift(PC_IO Mask in_phase, Mask free, Vec3 half_change, Vec3 a) {
  Real h = PC_INFO(h);
  Real share = PC_INFO(h_change);
  precise Vec3 kick = a * (h * PC_REAL(-0.5));
  precise Real half_time = PC_INFO(h_before) * share * PC_REAL(0.5);
  Vec3 shift = pc_select3(free, pc_scale(a, half_time), pc_scale(half_change, share));
  return pc_select3(in_phase, kick, shift);
}
#endif

// Adds a shift to a velocity that is the sum of `high` and `low`.
PC_FN void pc_add_shift(Mask dynamic_body, Vec3 shift, PC_INOUT(Vec3) high, PC_INOUT(Vec3) low) {
  TwoSum sum = pc_two_sum(high, pc_add(shift, low));
  high = pc_select3(dynamic_body, sum.sum, high);
  low = pc_select3(dynamic_body, pc_snap3(sum.low), low);
}

struct VelocityShift {
  Vec3 u;
  Vec3 l;
};
#ifndef PC_SEED
PC_FN VelocityShift pc_velocity_shift(PC_IO Quad linear, Quad angular, Quad linear_change, Quad angular_change,
                                      Quad push, Quad turn) {
  Mask dynamic_body = linear.s > PC_REAL(0.0);
  Mask in_phase = pc_and(angular.s < PC_REAL(0.0), dynamic_body);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 acceleration = pc_madd(gravity, push.v, linear.s);
  Mask free = pc_and(PC_INFO(by_forces) > PC_REAL(0.5), angular.s < PC_TINY);
  VelocityShift s;
#ifdef PC_DRAG
  s.u = pc_shift(PC_PASS in_phase, free, linear.v, linear_change.v, acceleration, push.s);
  s.l = pc_shift(PC_PASS in_phase, free, angular.v, angular_change.v, turn.v, turn.s);
#else
  s.u = pc_shift(PC_PASS in_phase, free, linear_change.v, acceleration);
  s.l = pc_shift(PC_PASS in_phase, free, angular_change.v, turn.v);
#endif
  return s;
}
#endif
