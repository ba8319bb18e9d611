// One visit of a manifold's rows: friction at the centre, then the normal rows together (with accumulated impulses),
// from the relative twist at its centre to the change of its impulses.
#include "contact_friction.inl"
#include "contact_together.inl"
#include "contact_shift.inl"

// What one normal row asks for, as a change of its impulse. Open rows (s > 0) are speculative: they stop what would
// close the gap within this sub-step. Closed ones push the overlap out, as a soft constraint: they let go of a share of
// their impulse. Where one body stands, or one hangs on joints, that is a share of what the manifold's load goes beyond
// a few weights of what answers it (`loose`), so that what lies alone does not sink, also where one side of it carries
// more; and together of no more than twice the load of the sub-step before: what has just come is a blow, which is
// stopped.
#ifdef PC_TREES
// What a row that bounces asks for: to leave with `back`, above 0.
PC_FN Real pc_thrown(Real change, Real vn, Real mass, Real back) {
  precise Real bounce = mass * (back - vn);
  return pc_select(back > PC_REAL(0.0), bounce, change);
}
// It was of an instant: nothing of it is remembered.
PC_FN Real pc_lasts(Real impulse, Real back) { return pc_select(back > PC_REAL(0.0), PC_REAL(0.0), impulse); }
#define PC_BACK , FourRows back
#else
#define pc_thrown(change, vn, mass, back) change
#define pc_lasts(impulse, back) impulse
#define PC_BACK
#endif
// Of what would close a gap within the sub-step, what is more than rounding: than a millionth of what gravity closes in
// one.
PC_FN Real pc_beyond_rounding(PC_IO Real gap_rate) {
  precise Real beyond = gap_rate - PC_INFO(least_load) * PC_LITTLE;
  return beyond;
}
PC_FN Mask pc_is_open(PC_IO Real gap_rate) { return pc_beyond_rounding(PC_PASS gap_rate) > PC_REAL(0.0); }
// What a row gives way by, as an impulse: what it lets go of, less what it pushes out.
PC_FN Real pc_row_give(PC_IO Real vn, Real s, Real mass, Real impulse, Real loose) {
  precise Real gap_rate = s * PC_INFO(inverse_h);
  precise Real pushed = s * PC_INFO(soft_rate);
  Mask open = pc_is_open(PC_PASS gap_rate);
  Real bias = pc_select(open, gap_rate, pushed);
  Real leak = pc_select(open, PC_REAL(0.0), PC_INFO(soft_impulse_scale));
  precise Real rigid = impulse - mass * (vn + bias);
  precise Real beyond = rigid * loose;
  precise Real give = mass * bias + pc_max(beyond, PC_REAL(0.0)) * leak;
  return give;
}
#ifdef PC_TREES
#define PC_MOST_PUSH PC_INFO(tree_push_speed)
// What of it the velocities leave to poses (tree_contact_push), below 0; else how much the row may yet be closed.
PC_FN Real pc_row_room(PC_IO Real vn, Real s, Real mass, Real impulse, Real loose) {
  precise Real more = pc_row_give(PC_PASS vn, s, mass, impulse, loose) + mass * PC_MOST_PUSH;
  precise Real gap_rate = s * PC_INFO(inverse_h);
  precise Real gap = mass * gap_rate;
  return pc_select(pc_is_open(PC_PASS gap_rate), gap, pc_min(more, PC_REAL(0.0)));
}
#else
#define PC_MOST_PUSH PC_INFO(row_push_speed)
#endif
PC_FN Real pc_row_change(PC_IO Real vn, Real s, Real mass, Real impulse, Real loose) {
  precise Real gap_rate = s * PC_INFO(inverse_h);
  // (what the row lets go of and what it pushes out, together no faster than the push: any load is held)
  precise Real most = mass * PC_MOST_PUSH;
  precise Real change = -(mass * vn) - pc_max(pc_row_give(PC_PASS vn, s, mass, impulse, loose), -most);
  // in the relax pass an open row that holds nothing waits for the sub-step in which it closes
  Mask waits = pc_and(pc_and(pc_is_open(PC_PASS gap_rate), impulse < PC_TINY), PC_INFO(load_ahead) > PC_REAL(0.0));
  return pc_select(waits, -impulse, change);
}
#undef PC_MOST_PUSH
// New accumulated impulse of a row that takes this share of what it asks for.
PC_FN Real pc_row_after(Real impulse, Real change, Real share) {
  precise Real next = impulse + change * share;
  return pc_snap(pc_max(next, PC_REAL(0.0)));
}
PC_FN Real pc_normal_row(PC_IO Real vn, Real s, Real mass, Real impulse, Real loose) {
  return pc_row_after(impulse, pc_row_change(PC_PASS vn, s, mass, impulse, loose), PC_REAL(1.0));
}

PC_FN void pc_keep_largest(PC_IO Slot m, uint i, Mask acts, Real impulse) {
  Real before = PC_LD(contact_impulses, m, IMPULSE_LARGEST + i);
  PC_ST(contact_impulses, m, IMPULSE_LARGEST + i, pc_select(acts, pc_max(before, impulse), before));
}
// Accumulated impulses of the four points and of friction.
struct Rows {
  Real k0;
  Real k1;
  Real k2;
  Real k3;
  Friction f;
};
// Separations of now.
struct Gaps {
  Real s0;
  Real s1;
  Real s2;
  Real s3;
};
PC_FN Real pc_gap(PC_IO Slot m, uint i, Shift shift) {
  precise Real s = PC_LD(contact_rows, m, ROW_S + i) + (shift.n + PC_LD(contact_rows, m, ROW_B + i) * shift.turn1 -
                                                        PC_LD(contact_rows, m, ROW_A + i) * shift.turn2);
  // what meets in flight is stopped, where its impact left an approach, and not pushed
  return pc_select(PC_LD(contact_rows, m, ROW_IMPACT) > PC_REAL(0.0), pc_max(s, PC_REAL(0.0)), s);
}
#ifndef PC_TREES
#include "contact_settle.inl"
#endif

// Impulse and couple on b at the centre; and where there is a load, how much of it was there in the sub-step before and
// still is: what holds the two. (What has just come is a blow. After it a body may be slow, but it moves.)
#ifdef PC_TREES
struct Visit {
  Vec3 impulse;
  Vec3 couple;
  Real touch;
  FourRows room;
};
#else
struct Visit {
  Vec3 impulse;
  Vec3 couple;
  Real touch;
};
#endif
// Where it does not act all stays as it is.
PC_FN Visit pc_visit(PC_IO Slot m, Twist v, Shift shift, Vec3 n, Vec3 t1, Vec3 t2, Real preload, Mask acts PC_BACK) {
  Real l0 = PC_LD(contact_impulses, m, 0u);
  Real l1 = PC_LD(contact_impulses, m, 1u);
  Real l2 = PC_LD(contact_impulses, m, 2u);
  Real l3 = PC_LD(contact_impulses, m, 3u);

  // where no manifold of the block has a second point, the rows of the others are zeros
  Real others = pc_max(PC_LD(contact_rows, m, ROW_MASS + 1u),
                       pc_max(PC_LD(contact_rows, m, ROW_MASS + 2u), PC_LD(contact_rows, m, ROW_MASS + 3u)));
  Mask several = pc_max(others, pc_max(l1, pc_max(l2, l3))) > PC_REAL(0.0);
  bool more = PC_ANY(several);
  precise Real load = l0 + l1 + l2 + l3;
  precise Real inverse_load = pc_inverse_or_zero(load);
  Gaps gap;
  gap.s0 = pc_gap(PC_PASS m, 0u, shift);
  gap.s1 = gap.s0;
  gap.s2 = gap.s0;
  gap.s3 = gap.s0;
  Real apart = gap.s0;
  if (more) {  // lint: allow (as said)
    gap.s1 = pc_gap(PC_PASS m, 1u, shift);
    gap.s2 = pc_gap(PC_PASS m, 2u, shift);
    gap.s3 = pc_gap(PC_PASS m, 3u, shift);
    // of what carries the load: an edge that stands on a floor does so whatever the gap beside it
    precise Real carried = (l0 * gap.s0 + l1 * gap.s1 + l2 * gap.s2 + l3 * gap.s3) * inverse_load;
    Real nearest = pc_min(pc_min(gap.s0, gap.s1), pc_min(gap.s2, gap.s3));
    apart = pc_select(several, pc_select(load > PC_TINY, carried, nearest), apart);
  }

  // friction goes by the load that the normal rows, visited after it, are about to leave, were they rigid: what the
  // soft rows let go of in the biased visit they take up again in the relax visit. (What comes together later in the
  // sub-step does so elsewhere: its friction is the relax visit's.)
  precise Real gap_rate = pc_max(apart, PC_REAL(0.0)) * PC_INFO(inverse_h);
  Real mass = pc_inverse_or_zero(PC_LD(contact_rows, m, ROW_K));
#ifdef PC_TREES
  Real thrown = pc_max(pc_max(back.r0, back.r1), pc_max(back.r2, back.r3));
#else
  Real thrown = PC_REAL(0.0);
#endif
  precise Real coming = load - (v.vn + gap_rate - thrown) * mass;
  precise Real kept = mass * preload;
  precise Real beyond = PC_REAL(1.0) - kept * pc_inverse_or_zero(coming);
  Mask rests = pc_and(coming > PC_REAL(0.0), kept > coming);
  precise Real before = PC_LD(contact_impulses, m, IMPULSE_BEFORE) * pc_inverse_or_zero(coming);
  precise Real twice = before + before;
  Real loose = pc_select(rests, PC_REAL(0.0), pc_min(beyond, twice));
  Real not_yet = pc_max(pc_beyond_rounding(PC_PASS gap_rate), PC_INFO(load_ahead));
  Mask waits = pc_and(load<PC_TINY, not_yet> PC_REAL(0.0));
  Real ahead = pc_select(waits, PC_REAL(0.0), pc_max(coming, PC_REAL(0.0)));
  Friction f = pc_friction(PC_PASS m, v, ahead);
  Real vn = f.after.vn;
  Real w1 = f.after.w1;
  Real w2 = f.after.w2;

  // normal rows
  Real a0 = PC_LD(contact_rows, m, ROW_A);
  Real b0 = PC_LD(contact_rows, m, ROW_B);
  precise Real m0 = PC_LD(contact_rows, m, ROW_MASS);
  precise Real v0 = vn + b0 * w1 - a0 * w2;
  Real e0 = pc_thrown(pc_row_change(PC_PASS v0, gap.s0, m0, l0, loose), v0, m0, back.r0);
#ifdef PC_TREES
  FourRows room = pc_four(pc_row_room(PC_PASS v0, gap.s0, m0, l0, loose), PC_REAL(0.0), PC_REAL(0.0), PC_REAL(0.0));
#endif
  Rows now;
  now.k1 = l1;
  now.k2 = l2;
  now.k3 = l3;
  now.f = f;
  Real share_of_all = PC_REAL(1.0);
  if (more) {  // lint: allow (as said)
    Real a1 = PC_LD(contact_rows, m, ROW_A + 1u);
    Real b1 = PC_LD(contact_rows, m, ROW_B + 1u);
    precise Real m1 = PC_LD(contact_rows, m, ROW_MASS + 1u);
    Real a2 = PC_LD(contact_rows, m, ROW_A + 2u);
    Real b2 = PC_LD(contact_rows, m, ROW_B + 2u);
    precise Real m2 = PC_LD(contact_rows, m, ROW_MASS + 2u);
    Real a3 = PC_LD(contact_rows, m, ROW_A + 3u);
    Real b3 = PC_LD(contact_rows, m, ROW_B + 3u);
    precise Real m3 = PC_LD(contact_rows, m, ROW_MASS + 3u);
    precise Real v1 = vn + b1 * w1 - a1 * w2;
    Real e1 = pc_thrown(pc_row_change(PC_PASS v1, gap.s1, m1, l1, loose), v1, m1, back.r1);
    precise Real v2 = vn + b2 * w1 - a2 * w2;
    Real e2 = pc_thrown(pc_row_change(PC_PASS v2, gap.s2, m2, l2, loose), v2, m2, back.r2);
    precise Real v3 = vn + b3 * w1 - a3 * w2;
    Real e3 = pc_thrown(pc_row_change(PC_PASS v3, gap.s3, m3, l3, loose), v3, m3, back.r3);
#ifdef PC_TREES
    room.r1 = pc_row_room(PC_PASS v1, gap.s1, m1, l1, loose);
    room.r2 = pc_row_room(PC_PASS v2, gap.s2, m2, l2, loose);
    room.r3 = pc_row_room(PC_PASS v3, gap.s3, m3, l3, loose);
#endif
    Real together = pc_common_share(pc_four(l0, l1, l2, l3), pc_four(e0, e1, e2, e3), pc_four(m0, m1, m2, m3),
                                    pc_couplings(PC_PASS m));
    share_of_all = pc_select(several, together, PC_REAL(1.0));
    now.k1 = pc_row_after(l1, e1, share_of_all);
    now.k2 = pc_row_after(l2, e2, share_of_all);
    now.k3 = pc_row_after(l3, e3, share_of_all);
  }
  now.k0 = pc_row_after(l0, e0, share_of_all);
#ifndef PC_TREES
  precise Real arriving = load - (v.vn + gap_rate) * mass;
  Mask unsettled = pc_unsettled(PC_PASS m, load, arriving, ahead, mass, f);
  if (PC_ANY(unsettled)) {  // lint: allow (others keep what they have)
    pc_settle(PC_PASS m, v, gap, loose, unsettled, now);
  }
#ifndef PC_FRICTIONLESS
  // what slides goes by the load that was found in place of the one that was foreseen: where loads change, or are those
  // of roundings, the two differ in each sub-step, and what slides would take up the sum
  if (PC_ANY(PC_INFO(load_ahead) > PC_REAL(0.5))) {  // lint: allow (the same for all lanes)
    precise Real found = now.k0 + now.k1 + now.k2 + now.k3;
    Friction by_load = pc_friction(PC_PASS m, v, found);
    now.f.next1 = pc_select(unsettled, now.f.next1, by_load.next1);
    now.f.next2 = pc_select(unsettled, now.f.next2, by_load.next2);
    now.f.next_twist = pc_select(unsettled, now.f.next_twist, by_load.next_twist);
    now.f.change1 = pc_select(unsettled, now.f.change1, by_load.change1);
    now.f.change2 = pc_select(unsettled, now.f.change2, by_load.change2);
    now.f.change_twist = pc_select(unsettled, now.f.change_twist, by_load.change_twist);
  }
#endif
#endif
  now.k0 = pc_select(acts, now.k0, l0);
  now.k1 = pc_select(acts, now.k1, l1);
  now.k2 = pc_select(acts, now.k2, l2);
  now.k3 = pc_select(acts, now.k3, l3);
#ifndef PC_FRICTIONLESS
  now.f.next1 = pc_select(acts, now.f.next1, PC_LD(contact_impulses, m, IMPULSE_T));
  now.f.next2 = pc_select(acts, now.f.next2, PC_LD(contact_impulses, m, IMPULSE_T + 1u));
  now.f.next_twist = pc_select(acts, now.f.next_twist, PC_LD(contact_impulses, m, IMPULSE_T + 2u));
#endif
#ifndef PC_FRICTIONLESS
  PC_ST(contact_impulses, m, IMPULSE_T, now.f.next1);
  PC_ST(contact_impulses, m, IMPULSE_T + 1u, now.f.next2);
  PC_ST(contact_impulses, m, IMPULSE_T + 2u, now.f.next_twist);
#endif
  PC_ST(contact_impulses, m, 0u, pc_lasts(now.k0, back.r0));
  pc_keep_largest(PC_PASS m, 0u, acts, now.k0);
  if (more) {  // lint: allow (as said)
    PC_ST(contact_impulses, m, 1u, pc_lasts(now.k1, back.r1));
    pc_keep_largest(PC_PASS m, 1u, acts, now.k1);
    PC_ST(contact_impulses, m, 2u, pc_lasts(now.k2, back.r2));
    pc_keep_largest(PC_PASS m, 2u, acts, now.k2);
    PC_ST(contact_impulses, m, 3u, pc_lasts(now.k3, back.r3));
    pc_keep_largest(PC_PASS m, 3u, acts, now.k3);
  }
  precise Real c0 = now.k0 - l0;
  precise Real c1 = now.k1 - l1;
  precise Real c2 = now.k2 - l2;
  precise Real c3 = now.k3 - l3;
  precise Real pressed = now.k0 + now.k1 + now.k2 + now.k3;
  Push push = pc_push(PC_PASS m, c0, c1, c2, c3);
  Wrench w = pc_wrench(n, t1, t2, push, now.f.change1, now.f.change2, now.f.change_twist);
  Visit r;
  r.impulse = w.impulse;
  r.couple = w.couple;
  precise Real held = pc_min(PC_LD(contact_impulses, m, IMPULSE_BEFORE), pressed);
  Mask touches = pc_max(load, pressed) > PC_REAL(0.0);
  r.touch = pc_select(touches, pc_max(held, PC_TINY), PC_REAL(0.0));
#ifdef PC_TREES
  r.room = room;
  // what a bounce leaves is to be read whole (synchronise)
  r.touch = pc_select(thrown > PC_REAL(0.0), pc_max(r.touch, push.n), r.touch);
#endif
  return r;
}
