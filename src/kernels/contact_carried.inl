// What a kinematic body that turns carries. Over a sub-step its points go along arcs, which their velocity of one
// instant leaves: a box that sticks to a turntable crept outwards by millimetres a second. So contacts go by the chord
// of the sub-step: of the one to come in the biased visit, in the relax visit of the same one, which then lies behind.
// Along the contact plane alone: where a roller turns under a body, its other points come up.
PC_FN Mask pc_turns_alone(BodyState b) { return pc_and(b.response<PC_REAL(0.5), pc_dot(b.l, b.l)> PC_REAL(0.0)); }
// Mean velocity of a point at `arm` over the sub-step, less that of now.
PC_FN Vec3 pc_chord(PC_IO BodyState b, Vec3 arm) {
  Vec3 w = pc_angular_velocity(b);
  precise Real way = PC_REAL(1.0) - PC_INFO(load_ahead) * PC_REAL(2.0);
  precise Real time = PC_INFO(h) * way;
  Turn turn = pc_turn(pc_scale(w, time));
  Vec3 moved = pc_swing(turn.q, arm);
  precise Vec3 off = moved * PC_INFO(inverse_h) * way - pc_cross(w, arm);
  return off;
}
PC_FN_LARGE Twist pc_by_chords(PC_IO Twist v, BodyState a, BodyState b, Arms arms, Vec3 t1, Vec3 t2) {
  Mask on_a = pc_turns_alone(a);
  Mask on_b = pc_turns_alone(b);
  Mask carried = pc_or(on_a, on_b);
  if (!PC_ANY(carried)) return v;  // lint: allow (other lanes keep what they have)
  Vec3 none = pc_zero3();
  Vec3 off =
      pc_sub(pc_select3(on_b, pc_chord(PC_PASS b, arms.b), none), pc_select3(on_a, pc_chord(PC_PASS a, arms.a), none));
  precise Real v1 = v.v1 + pc_dot(t1, off);
  precise Real v2 = v.v2 + pc_dot(t2, off);
  Twist r = v;
  r.v1 = pc_select(carried, v1, v.v1);
  r.v2 = pc_select(carried, v2, v.v2);
  return r;
}
PC_FN Twist pc_carried(PC_IO Twist v, BodyState a, BodyState b, Arms arms, Vec3 t1, Vec3 t2) {
  if (!PC_ANY(PC_INFO(carries) > PC_REAL(0.0))) return v;  // lint: allow (the same for all lanes)
  return pc_by_chords(PC_PASS v, a, b, arms, t1, t2);
}
