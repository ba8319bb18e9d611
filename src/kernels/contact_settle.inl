// A manifold whose load has just come, or whose friction has just let go: its rows are solved together, by further
// rounds of friction and normal rows. One round a visit is enough where the last sub-step's impulses still hold; here
// they do not, and what one round leaves (a box that tilts a little, and slides while it does) is never undone.
// (Manifolds of bodies on joints take no rounds.)
#ifdef PC_TREES
PC_FN Rows pc_settled(PC_IO Slot m, Twist v, Found found, Foreseen foreseen, Rows now) { return now; }
#else
const uint SETTLE_ROUNDS = 16u;  // of a visit that takes rounds; all lanes make as many

// Whether rounds are needed: more than one point, and the load becomes settled_load times what it is, or that part of
// it (of an impact that is remembered nothing is left); or in the biased visit friction changes by half of its limit.
// (Bodies that stand side by side press each other by rounding alone: no load.)
PC_FN Mask pc_unsettled(PC_IO Slot m, Found found, Foreseen foreseen, Friction f) {
  precise Real least = found.mass * PC_INFO(least_load);
  Mask loaded = pc_max(found.load, pc_max(foreseen.load, foreseen.ahead)) > least;
  precise Real more = foreseen.load - found.load * PC_INFO(settled_load);
  precise Real less = found.load - pc_max(foreseen.load, PC_REAL(0.0)) * PC_INFO(settled_load);
  Mask several = pc_and(PC_LD(contact_rows, m, ROW_MASS + 1u) > PC_REAL(0.0), loaded);
  Mask changes = pc_max(more, less) > PC_REAL(0.0);
#ifndef PC_FRICTIONLESS
  precise Real change = f.change1 * f.change1 + f.change2 * f.change2;
  precise Real limit = foreseen.ahead * PC_LD(contact_rows, m, ROW_MU_KINETIC) * PC_REAL(0.5);
  precise Real square = limit * limit;
  Mask biased = PC_INFO(load_ahead) < PC_REAL(0.5);
  changes = pc_or(changes, pc_and(biased, change > square));
#endif
  return pc_and(several, changes);
}

// In a round all rows move at once, so that no point comes before another: each by a share of what would stop its own
// point that is safe whatever the others do (half as much again as its part in the sum of the responses that it feels).
PC_FN Real pc_pace(Real own, Real x, Real y, Real z) {
  precise Real sum = own + pc_abs(x) + pc_abs(y) + pc_abs(z);
  precise Real pace = own * pc_inverse_or_zero(sum);
  precise Real more = pace + pace * PC_REAL(0.5);
  return pc_min(more, PC_REAL(1.0));
}
// What is the same in each round.
struct Settling {
  FourRows mass;
  FourRows own;  // response of each row to itself
  Couplings d;
  FourRows pace;
};
// Response to a row, where that exists.
PC_FN Real pc_response_to(Real mass, Real response) {
  Real exists = pc_select(mass > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  precise Real r = response * exists;
  return r;
}
PC_FN Settling pc_settling(PC_IO Slot m) {
  FourRows mass = pc_ld4_rows(PC_PASS m, ROW_MASS);
  FourRows own = pc_four(pc_inverse_or_zero(mass.r0), pc_inverse_or_zero(mass.r1), pc_inverse_or_zero(mass.r2),
                         pc_inverse_or_zero(mass.r3));
  Couplings d = pc_couplings(PC_PASS m);
  d.d02 = pc_response_to(mass.r2, d.d02);
  d.d03 = pc_response_to(mass.r3, d.d03);
  d.d12 = pc_response_to(mass.r2, d.d12);
  d.d13 = pc_response_to(mass.r3, d.d13);
  d.d23 = pc_response_to(mass.r3, d.d23);
  Settling r;
  r.mass = mass;
  r.own = own;
  r.d = d;
  r.pace = pc_four(pc_pace(own.r0, d.d01, d.d02, d.d03), pc_pace(own.r1, d.d01, d.d12, d.d13),
                   pc_pace(own.r2, d.d02, d.d12, d.d23), pc_pace(own.r3, d.d03, d.d13, d.d23));
  return r;
}
PC_FN Real pc_settled_row(PC_IO Real v, Real s, Real mass, Real now, Real pace, Real loose) {
  precise Real next = now + (pc_normal_row(PC_PASS v, s, mass, now, loose) - now) * pace;
  return pc_snap(next);
}
// One round of the normal rows, which so far have changed by `e` since the visit began.
// `v`: the twist before that, after friction.
PC_FN FourRows pc_settle_normals(PC_IO Slot m, Settling r, Twist v, FourRows gap, Real loose, FourRows now,
                                 FourRows e) {
  FourRows own = r.own;
  Couplings d = r.d;
  precise Real v0 = pc_row_approach(PC_PASS m, 0u, v) + (own.r0 * e.r0 + d.d01 * e.r1 + d.d02 * e.r2 + d.d03 * e.r3);
  precise Real v1 = pc_row_approach(PC_PASS m, 1u, v) + (own.r1 * e.r1 + d.d01 * e.r0 + d.d12 * e.r2 + d.d13 * e.r3);
  precise Real v2 = pc_row_approach(PC_PASS m, 2u, v) + (own.r2 * e.r2 + d.d02 * e.r0 + d.d12 * e.r1 + d.d23 * e.r3);
  precise Real v3 = pc_row_approach(PC_PASS m, 3u, v) + (own.r3 * e.r3 + d.d03 * e.r0 + d.d13 * e.r1 + d.d23 * e.r2);
  return pc_four(pc_settled_row(PC_PASS v0, gap.r0, r.mass.r0, now.r0, r.pace.r0, loose),
                 pc_settled_row(PC_PASS v1, gap.r1, r.mass.r1, now.r1, r.pace.r1, loose),
                 pc_settled_row(PC_PASS v2, gap.r2, r.mass.r2, now.r2, r.pace.r2, loose),
                 pc_settled_row(PC_PASS v3, gap.r3, r.mass.r3, now.r3, r.pace.r3, loose));
}

// The rounds. `v`: the twist before the visit; `r`: impulses after the visit's one round.
PC_FN void pc_settle(PC_IO Slot m, Twist v, Found found, Real loose, Mask unsettled, PC_INOUT(Rows) r) {
  Settling same = pc_settling(PC_PASS m);
  FourRows now = found.impulse;
  FourRows change = pc_sub4(now, found.impulse);
  Friction f = r.friction;
  for (uint k = 0u; k < SETTLE_ROUNDS; k++) {
    now = pc_settle_normals(PC_PASS m, same, f.after, found.gap, loose, now, change);
    change = pc_sub4(now, found.impulse);
    Push push = pc_push(PC_PASS m, change.r0, change.r1, change.r2, change.r3);
    f = pc_friction(PC_PASS m, pc_pushed_twist(PC_PASS m, v, push), pc_sum4(now));
  }
  r.normal = pc_select4(unsettled, now, r.normal);
  r.friction = pc_select_friction(unsettled, f, r.friction);
}
// What the visit's one round has come to, or more rounds come to where they are needed. `v`: the twist before.
PC_FN Rows pc_settled(PC_IO Slot m, Twist v, Found found, Foreseen foreseen, Rows now) {
  Mask unsettled = pc_unsettled(PC_PASS m, found, foreseen, now.friction);
  if (PC_ANY(unsettled)) {  // lint: allow (others keep what they have)
    pc_settle(PC_PASS m, v, found, foreseen.loose, unsettled, now);
  }
  // what slides goes by the load that was found in place of the one that was foreseen: where loads change, or are those
  // of roundings, the two differ in each sub-step, and what slides would take up the sum
  if (PC_ANY(PC_INFO(load_ahead) > PC_REAL(0.5))) {  // lint: allow (the same for all lanes)
    Friction by_load = pc_friction(PC_PASS m, v, pc_sum4(now.normal));
    now.friction = pc_select_friction(unsettled, now.friction, by_load);
  }
  return now;
}
#endif
