#include "net_second.inl"
#include "net_whole.inl"

// What a net does in a sub-step that Newton's method did not solve: it makes no energy.

// The energy that the sub-step will have made with the impulses as they are, and what there is of it.
struct Energy {
  Real made;
  Real scale;
};
PC_FN Real pc_net_stored(PC_IO Slot s, Real length) {
  precise Real longer = length - PC_LD(net_rows, s, NET_REST);
  precise Real stored = PC_LD(net_rows, s, NET_STIFFNESS) * longer * longer * PC_REAL(0.5);
  return stored;
}
// What comes after the bodies have moved, at the poses that are foreseen.
PC_FN Second pc_foreseen_second(PC_IO Slot s, Slot a, Slot b) {
  Vec3 start_a = pc_ld3_net(PC_PASS s, NET_START);
  Vec3 start_b = pc_ld3_net(PC_PASS s, NET_START + 3u);
  Vec3 swing_a = pc_net_swing(PC_PASS a, start_a);
  Vec3 swing_b = pc_net_swing(PC_PASS b, start_b);
  Vec3 first_line = pc_ld3_net(PC_PASS s, NET_LINE);
  Vec3 apart = pc_sub(pc_ld3_net(PC_PASS b, NET_STEP), pc_ld3_net(PC_PASS a, NET_STEP));
  Vec3 line = pc_add(first_line, pc_add(apart, pc_sub(swing_b, swing_a)));
  Vec3 shift_a = pc_sub(pc_ld3_net(PC_PASS s, NET_ARM_A), start_a);
  Vec3 shift_b = pc_sub(pc_ld3_net(PC_PASS s, NET_ARM_B), start_b);
  Vec3 lever = pc_add(first_line, pc_sub(shift_b, shift_a));
  Vec3 couple = pc_cross(lever, pc_ld3_net(PC_PASS s, NET_IMPULSE));
  return pc_second_half(PC_PASS s, a, b, line, couple, pc_add(start_a, swing_a), pc_add(start_b, swing_b));
}
PC_FN Energy pc_net_energy(PC_IO Slot m, Net n) {
  Energy e;
  e.made = PC_REAL(0.0);
  e.scale = PC_REAL(0.0);
  pc_net_begin_after(PC_PASS m, n, NET_SUM, PC_REAL(1.0));
  for (uint k = 0u; k < n.bodies; k++) {
    pc_net_foresee(PC_PASS pc_net_body(PC_PASS m, n, k), pc_net_row(PC_PASS m, n, k));
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Slot a = pc_net_end(PC_PASS m, n, k, 0u);
    Slot b = pc_net_end(PC_PASS m, n, k, 1u);
    pc_add_second(PC_PASS a, b, NET_SUM, pc_foreseen_second(PC_PASS s, a, b));
  }
  pc_net_velocities(PC_PASS m, n);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Vec3 push = pc_ld3_net(PC_PASS b, NET_SUM);
    Vec3 turn = pc_ld3_net(PC_PASS b, NET_SUM + 3u);
    precise Real half_mass = PC_LD(net_rows, b, NET_MASS) * PC_REAL(0.5);
    Vec3 v = pc_madd(pc_ld3_net(PC_PASS b, NET_RATE), push, half_mass);
    Vec3 turned = pc_sym_mul(pc_lds_net(PC_PASS b, NET_INERTIA), turn);
    Vec3 w = pc_madd(pc_ld3_net(PC_PASS b, NET_RATE + 3u), turned, PC_REAL(0.5));
    precise Real second = pc_dot(push, v) + pc_dot(turn, w);
    precise Real made = e.made + pc_net_count(PC_PASS b) + second;
    e.made = made;
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_net_look(PC_PASS s, pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u), PC_REAL(0.0));
    Real before = pc_net_stored(PC_PASS s, PC_LD(net_rows, s, NET_LENGTH));
    Real after = pc_net_stored(PC_PASS s, PC_LD(net_rows, s, NET_THEN));
    precise Real made = e.made + (after - before);
    precise Real scale = e.scale + before;
    e.made = made;
    e.scale = scale;
  }
  precise Real all = e.made + pc_net_held(PC_PASS m, n);
  e.made = all;
  return e;
}

// The motion of the whole net as one rigid body with its momenta; or, where something holds it, that of what does.
struct Rigid {
  Vec3 v;
  Vec3 l;
  Vec3 centre;
  Whole all;
};
PC_FN Rigid pc_net_rigid(PC_IO Slot m, Net n) {
  Rigid r;
  Real zero = PC_REAL(0.0);
  Whole all = pc_net_whole(PC_PASS m, n, zero);
  r.all = all;
  r.centre = all.centre;
  Mask held = zero > PC_REAL(1.0);
  Vec3 held_v = pc_zero3();
  Vec3 held_at = pc_zero3();
  Vec3 p = pc_zero3();
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    Mask stands = pc_select(heavy > zero, zero, PC_REAL(1.0)) > PC_REAL(0.5);
    Vec3 told = pc_ld3_net(PC_PASS b, NET_VELOCITY);
    held_v = pc_select3(pc_and(stands, pc_dot(told, told) > pc_dot(held_v, held_v)), told, held_v);
    held_at = pc_select3(stands, pc_net_place(PC_PASS m, n, k), held_at);
    held = pc_or(held, stands);
    p = pc_madd(p, told, heavy);
  }
  r.v = pc_scale(p, all.light);
  Vec3 l = pc_zero3();
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    Vec3 arm = pc_sub(pc_net_place(PC_PASS m, n, k), r.centre);
    Vec3 orbit = pc_cross(arm, pc_sub(pc_ld3_net(PC_PASS b, NET_VELOCITY), r.v));
    Vec3 spun = pc_ld3_net(PC_PASS b, NET_MOMENTUM);
    l = pc_madd(pc_madd(l, orbit, heavy), spun, pc_select(heavy > zero, PC_REAL(1.0), zero));
  }
  r.l = pc_select3(held, pc_zero3(), l);
  r.v = pc_select3(held, held_v, r.v);
  r.centre = pc_select3(held, held_at, r.centre);
  return r;
}
// How it spins once it has turned so: its angular momentum stays.
PC_FN Vec3 pc_rigid_spin(Rigid r, Quaternion turn) {
  return pc_rotate(turn, pc_net_spin(r.all, pc_rotate(pc_conjugate(turn), r.l)));
}
// The angular momentum of a body of such moments, once it has turned so.
PC_FN Vec3 pc_rigid_momentum(Sym3 moments, Quaternion turn, Vec3 spin) {
  return pc_rotate(turn, pc_sym_mul(moments, pc_rotate(pc_conjugate(turn), spin)));
}
// What the net is given to move so. It moves along the chords of its turn, so that its springs stay as long as they are
// (along tangents they grow by the square of it), and when it has moved it is given the velocities that it has then.
// Each body turns freely, which is as the whole turns with the inertia that it has half way.
PC_FN void pc_net_stiffen(PC_IO Slot m, Net n, Rigid r, Mask these) {
  Vec3 sum = pc_zero3();
  Real zero = PC_REAL(0.0);
  precise Real half_time = PC_INFO(h) * PC_REAL(0.5);
  Quaternion early = pc_turn(pc_scale(pc_rigid_spin(r, pc_quaternion(pc_zero3(), PC_REAL(1.0))), half_time)).q;
  Vec3 mean = pc_rigid_spin(r, early);
  Quaternion half_turn = pc_turn(pc_scale(mean, half_time)).q;
  Quaternion turn = pc_turn(pc_scale(mean, PC_INFO(h))).q;
  Vec3 spin = pc_rigid_spin(r, turn);
  Vec3 lever = pc_zero3();
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Index row = pc_net_row(PC_PASS m, n, k);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    Vec3 arm = pc_sub(pc_net_place(PC_PASS m, n, k), r.centre);
    Sym3 moments = pc_net_moments(PC_PASS row);
    Vec3 way = pc_swing_closely(turn, arm);
    Vec3 chord = pc_madd(r.v, way, PC_INFO(inverse_h));
    Vec3 l = pc_rigid_momentum(moments, half_turn, mean);
    Vec3 v_then = pc_add(r.v, pc_cross(spin, pc_add(arm, way)));
    Vec3 l_then = pc_rigid_momentum(moments, turn, spin);
    Mask here = heavy > zero;
    Vec3 push = pc_scale(pc_sub(chord, pc_ld3_net(PC_PASS b, NET_VELOCITY)), heavy);
    Vec3 twist = pc_sub(l, pc_ld3_net(PC_PASS b, NET_MOMENTUM));
    pc_net_keep(PC_PASS b, NET_RIGID, these, push);
    pc_net_keep(PC_PASS b, NET_RIGID + 3u, these, pc_select3(here, twist, pc_zero3()));
    Vec3 after = pc_scale(pc_sub(v_then, chord), heavy);
    Vec3 twist_after = pc_select3(here, pc_sub(l_then, l), pc_zero3());
    pc_net_keep(PC_PASS b, NET_AFTER, these, after);
    pc_net_keep(PC_PASS b, NET_AFTER + 3u, these, twist_after);
    lever = pc_add(lever, pc_add(pc_cross(pc_add(arm, way), after), twist_after));
    sum = pc_add(sum, push);
  }
  pc_net_keep(PC_PASS pc_net_body(PC_PASS m, n, 0u), NET_LEVER, these, lever);
  // what holds the net takes what its momentum lacks, the fastest of it by its velocity: others do no work
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Mask stands = pc_select(PC_LD(net_rows, b, NET_MASS) > zero, zero, PC_REAL(1.0)) > PC_REAL(0.5);
    pc_net_keep(PC_PASS b, NET_RIGID, pc_and(these, stands), pc_negate(sum));
    pc_st3_net(PC_PASS b, NET_SOLVED, pc_ld3_net(PC_PASS b, NET_PUSH));
    pc_st3_net(PC_PASS b, NET_SOLVED + 3u, pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_st3_net(PC_PASS s, NET_FOUND, pc_ld3_net(PC_PASS s, NET_IMPULSE));
  }
}
// A share of what was solved, and for the rest the rigid motion, where `brings`.
PC_FN void pc_net_blend(PC_IO Slot m, Net n, Real share, Mask brings) {
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    for (uint i = 0u; i < 6u; i += 3u) {
      Vec3 rigid = pc_ld3_net(PC_PASS b, NET_RIGID + i);
      Vec3 more = pc_sub(pc_ld3_net(PC_PASS b, NET_SOLVED + i), rigid);
      pc_net_keep(PC_PASS b, NET_PUSH + i, brings, pc_net_further(rigid, more, share));
    }
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_net_keep(PC_PASS s, NET_IMPULSE, brings, pc_net_further(pc_zero3(), pc_ld3_net(PC_PASS s, NET_FOUND), share));
  }
}
// Where Newton's method did not come far enough, and the sub-step would make energy, the net goes a quarter of the way
// from the rigid motion to what was solved, then a quarter of that, and so on; in later solves of the sub-step, against
// contacts, it is rigid at once: between the two they would push it apart. Of these ways it keeps what makes least.
PC_FN void pc_net_bound(PC_IO Slot m, Net n, Mask asked) {
  Real motion = PC_REAL(0.0);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Vec3 v = pc_ld3_net(PC_PASS b, NET_VELOCITY);
    precise Real sum = motion + pc_dot(v, v) * pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS)) * PC_REAL(0.5);
    motion = sum;
  }
  Slot keeper = pc_net_body(PC_PASS m, n, 0u);
  Real owed = PC_LD(net_rows, keeper, NET_OWED);
  Real fresh = PC_LD(net_rows, keeper, NET_FRESH);
  Mask makes = asked;
  Real share = PC_REAL(1.0);
  Real kept = share;
  Real least = PC_REAL(0.0);
  uint rounds = PC_COUNT(rounds);
  for (uint i = 0u; i < rounds; i++) {
    Energy e = pc_net_energy(PC_PASS m, n);
    precise Real most = (e.scale + motion) * PC_INFO(net_made) - owed;
    Mask better = pc_and(makes, pc_or(least > e.made, share > PC_REAL(0.5)));  // all of it is looked at first
    kept = pc_select(better, share, kept);
    least = pc_select(better, e.made, least);
    makes = pc_and(makes, e.made > pc_max(most, PC_REAL(0.0)));
    if (!PC_ANY(makes)) return;  // lint: allow (others keep what they have)
    if (i == 0u) pc_net_stiffen(PC_PASS m, n, pc_net_rigid(PC_PASS m, n), makes);
    uint left = rounds - 1u - i;
    Mask goes = pc_and(share > PC_REAL(0.0), PC_IS(left));
    // the last look is at the rigid motion
    Real quarter = pc_select(PC_IS(left - 1u), pc_quarter(share), PC_REAL(0.0));
    precise Real part = quarter * fresh;
    share = pc_select(goes, part, kept);
    pc_net_blend(PC_PASS m, n, share, makes);
    precise Real rigid = PC_REAL(1.0) - share;
    PC_ST(net_rows, keeper, NET_BOUND, pc_select(makes, rigid, PC_LD(net_rows, keeper, NET_BOUND)));
    makes = pc_and(makes, goes);
    if (!PC_ANY(makes)) return;  // lint: allow (others keep what they have)
  }
}
