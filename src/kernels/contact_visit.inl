// One visit of a manifold's rows: friction at the centre, then the normal rows together (with accumulated impulses),
// from the relative twist at its centre to the change of its impulses.
#include "contact_friction.inl"
#include "contact_together.inl"
#include "contact_shift.inl"
#include "row_approach.inl"

// How fast what overlaps is pushed out at most.
#ifdef PC_TREES
#define PC_MOST_PUSH PC_INFO(tree_push_speed)
#else
#define PC_MOST_PUSH PC_INFO(row_push_speed)
#endif
// Of what would close a gap within the sub-step, what is more than rounding:
// than a millionth of what gravity closes in one.
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
// What of it the velocities leave to poses (tree_contact_push), below 0; else how much the row may yet be closed.
PC_FN Real pc_row_room(PC_IO Real vn, Real s, Real mass, Real impulse, Real loose) {
  precise Real more = pc_row_give(PC_PASS vn, s, mass, impulse, loose) + mass * PC_MOST_PUSH;
  precise Real gap_rate = s * PC_INFO(inverse_h);
  precise Real gap = mass * gap_rate;
  return pc_select(pc_is_open(PC_PASS gap_rate), gap, pc_min(more, PC_REAL(0.0)));
}
// What one normal row asks for, as a change of its impulse. Open rows (s > 0) are speculative: they stop what would
// close the gap within this sub-step. Closed ones push the overlap out, as a soft constraint: they let go of a share of
// their impulse. Where one body stands, or one hangs on joints, that is a share of what the manifold's load goes beyond
// a few weights of what answers it (`loose`), so that what lies alone does not sink, also where one side of it carries
// more; and together of no more than twice the load of the sub-step before: what has just come is a blow,
// which is stopped.
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
// What a row that bounces asks for: to leave with `back`, above 0.
PC_FN Real pc_thrown(Real change, Real vn, Real mass, Real back) {
  precise Real bounce = mass * (back - vn);
  return pc_select(back > PC_REAL(0.0), bounce, change);
}
// It was of an instant: nothing of it is remembered.
PC_FN Real pc_lasts(Real impulse, Real back) { return pc_select(back > PC_REAL(0.0), PC_REAL(0.0), impulse); }
// New accumulated impulse of a row that takes this share of what it asks for.
PC_FN Real pc_row_after(Real impulse, Real change, Real share) {
  precise Real next = impulse + change * share;
  return pc_snap(pc_max(next, PC_REAL(0.0)));
}
PC_FN Real pc_normal_row(PC_IO Real vn, Real s, Real mass, Real impulse, Real loose) {
  return pc_row_after(impulse, pc_row_change(PC_PASS vn, s, mass, impulse, loose), PC_REAL(1.0));
}

PC_FN Real pc_gap(PC_IO Slot m, uint i, Shift shift) {
  precise Real s = PC_LD(contact_rows, m, ROW_S + i) + (shift.n + PC_LD(contact_rows, m, ROW_B + i) * shift.turn1 -
                                                        PC_LD(contact_rows, m, ROW_A + i) * shift.turn2);
  // what meets in flight is stopped, where its impact left an approach, and not pushed
  return pc_select(PC_LD(contact_rows, m, ROW_IMPACT) > PC_REAL(0.0), pc_max(s, PC_REAL(0.0)), s);
}
// The normal rows as a visit finds them.
struct Found {
  FourRows impulse;
  FourRows gap;  // separations of now
  Mask several;  // where there is more than one point
  Real load;
  Real apart;  // separation of the whole
  Real mass;   // effective mass at the centre
};
PC_FN Found pc_found(PC_IO Slot m, Shift shift) {
  Found r;
  r.mass = pc_inverse_or_zero(PC_LD(contact_rows, m, ROW_K));
  r.impulse = pc_four(PC_LD(contact_impulses, m, 0u), PC_LD(contact_impulses, m, 1u), PC_LD(contact_impulses, m, 2u),
                      PC_LD(contact_impulses, m, 3u));
  r.load = pc_sum4(r.impulse);
  r.apart = pc_gap(PC_PASS m, 0u, shift);
  r.gap = pc_four(r.apart, r.apart, r.apart, r.apart);
  // where no manifold of the block has a second point, the rows of the others are zeros
  r.several =
      pc_max(pc_mass_of_others(PC_PASS m), pc_max(r.impulse.r1, pc_max(r.impulse.r2, r.impulse.r3))) > PC_REAL(0.0);
  if (PC_ANY(r.several)) {  // lint: allow (as said)
    r.gap.r1 = pc_gap(PC_PASS m, 1u, shift);
    r.gap.r2 = pc_gap(PC_PASS m, 2u, shift);
    r.gap.r3 = pc_gap(PC_PASS m, 3u, shift);
    // of what carries the load: an edge that stands on a floor does so whatever the gap beside it
    precise Real carried =
        (r.impulse.r0 * r.gap.r0 + r.impulse.r1 * r.gap.r1 + r.impulse.r2 * r.gap.r2 + r.impulse.r3 * r.gap.r3) *
        pc_inverse_or_zero(r.load);
    r.apart = pc_select(r.several, pc_select(r.load > PC_TINY, carried, pc_smallest4(r.gap)), r.apart);
  }
  return r;
}

// What the normal rows are about to leave.
struct Foreseen {
  Real load;   // were they rigid
  Real ahead;  // by which friction goes
  Real loose;  // share of it that soft rows let go of, see pc_row_change
};
// Friction goes by the load that the normal rows, visited after it, are about to leave, were they rigid: what the
// soft rows let go of in the biased visit they take up again in the relax visit. (What comes together later in the
// sub-step does so elsewhere: its friction is the relax visit's.)
PC_FN Foreseen pc_foresee(PC_IO Slot m, Found found, Real vn, Real thrown, Real preload) {
  precise Real gap_rate = pc_max(found.apart, PC_REAL(0.0)) * PC_INFO(inverse_h);
  precise Real coming = found.load - (vn + gap_rate - thrown) * found.mass;
  precise Real kept = found.mass * preload;
  precise Real beyond = PC_REAL(1.0) - kept * pc_inverse_or_zero(coming);
  Mask rests = pc_and(coming > PC_REAL(0.0), kept > coming);
  precise Real before = PC_LD(contact_impulses, m, IMPULSE_BEFORE) * pc_inverse_or_zero(coming);
  precise Real twice = before + before;
  Real not_yet = pc_max(pc_beyond_rounding(PC_PASS gap_rate), PC_INFO(load_ahead));
  Mask waits = pc_and(not_yet > PC_REAL(0.0), found.load < PC_TINY);
  Foreseen r;
  r.load = coming;
  r.ahead = pc_select(waits, PC_REAL(0.0), pc_max(coming, PC_REAL(0.0)));
  r.loose = pc_select(rests, PC_REAL(0.0), pc_min(beyond, twice));
  return r;
}

// Accumulated impulses of the four points and of friction, and the room that the points have (pc_row_room).
struct Rows {
  FourRows normal;
  Friction friction;
  FourRows room;
};
// What one normal row asks for.
struct Asked {
  Real change;
  Real mass;
  Real room;
};
PC_FN Asked pc_asked(PC_IO Slot m, uint i, Twist v, Real s, Real impulse, Real loose, Real back) {
  Real vn = pc_row_approach(PC_PASS m, i, v);
  Asked r;
  r.mass = PC_LD(contact_rows, m, ROW_MASS + i);
  r.change = pc_thrown(pc_row_change(PC_PASS vn, s, r.mass, impulse, loose), vn, r.mass, back);
  r.room = pc_row_room(PC_PASS vn, s, r.mass, impulse, loose);
  return r;
}
// The normal rows, together, after friction.
PC_FN Rows pc_press(PC_IO Slot m, Found found, Friction f, Real loose, FourRows back) {
  FourRows l = found.impulse;
  FourRows gap = found.gap;
  Asked e0 = pc_asked(PC_PASS m, 0u, f.after, gap.r0, l.r0, loose, back.r0);
  Real share_of_all = PC_REAL(1.0);
  Rows r;
  r.normal = l;
  r.friction = f;
  r.room = pc_no_rows();
  r.room.r0 = e0.room;
  if (PC_ANY(found.several)) {  // lint: allow (as said)
    Asked e1 = pc_asked(PC_PASS m, 1u, f.after, gap.r1, l.r1, loose, back.r1);
    Asked e2 = pc_asked(PC_PASS m, 2u, f.after, gap.r2, l.r2, loose, back.r2);
    Asked e3 = pc_asked(PC_PASS m, 3u, f.after, gap.r3, l.r3, loose, back.r3);
    Real together = pc_common_share(l, pc_four(e0.change, e1.change, e2.change, e3.change),
                                    pc_four(e0.mass, e1.mass, e2.mass, e3.mass), pc_couplings(PC_PASS m));
    share_of_all = pc_select(found.several, together, PC_REAL(1.0));
    r.normal.r1 = pc_row_after(l.r1, e1.change, share_of_all);
    r.normal.r2 = pc_row_after(l.r2, e2.change, share_of_all);
    r.normal.r3 = pc_row_after(l.r3, e3.change, share_of_all);
    r.room = pc_four(e0.room, e1.room, e2.room, e3.room);
  }
  r.normal.r0 = pc_row_after(l.r0, e0.change, share_of_all);
  return r;
}
#include "contact_settle.inl"

PC_FN void pc_store_normal(PC_IO Slot m, uint i, Real impulse, Real back, Mask acts) {
  PC_ST(contact_impulses, m, i, pc_lasts(impulse, back));
  Real before = PC_LD(contact_impulses, m, IMPULSE_LARGEST + i);
  PC_ST(contact_impulses, m, IMPULSE_LARGEST + i, pc_select(acts, pc_max(before, impulse), before));
}
PC_FN void pc_store_normals(PC_IO Slot m, FourRows impulse, FourRows back, Mask several, Mask acts) {
  pc_store_normal(PC_PASS m, 0u, impulse.r0, back.r0, acts);
  if (PC_ANY(several)) {  // lint: allow (as said)
    pc_store_normal(PC_PASS m, 1u, impulse.r1, back.r1, acts);
    pc_store_normal(PC_PASS m, 2u, impulse.r2, back.r2, acts);
    pc_store_normal(PC_PASS m, 3u, impulse.r3, back.r3, acts);
  }
}

// Impulse and couple on b at the centre; and where there is a load, how much of it was there in the sub-step before and
// still is: what holds the two. (What has just come is a blow. After it a body may be slow, but it moves.)
struct Visit {
  Vec3 impulse;
  Vec3 couple;
  Real touch;
  FourRows room;
};
PC_FN Real pc_touch(PC_IO Slot m, Real load, Real pressed) {
  Real held = pc_min(PC_LD(contact_impulses, m, IMPULSE_BEFORE), pressed);
  Mask touches = pc_max(load, pressed) > PC_REAL(0.0);
  return pc_select(touches, pc_max(held, PC_TINY), PC_REAL(0.0));
}
// `back`: the speeds with which rows are to bounce, 0 where they do not. Where it does not act all stays as it is.
PC_FN Visit pc_visit(PC_IO Slot m, Twist v, Shift shift, Vec3 n, Vec3 t1, Vec3 t2, Real preload, Mask acts,
                     FourRows back) {
  Found found = pc_found(PC_PASS m, shift);
  Real thrown = pc_largest4(back);
  Foreseen foreseen = pc_foresee(PC_PASS m, found, v.vn, thrown, preload);
  Friction f = pc_friction(PC_PASS m, v, foreseen.ahead);
  Rows now = pc_settled(PC_PASS m, v, found, foreseen, pc_press(PC_PASS m, found, f, foreseen.loose, back));
  now.normal = pc_select4(acts, now.normal, found.impulse);
  pc_store_friction(PC_PASS m, now.friction, acts);
  pc_store_normals(PC_PASS m, now.normal, back, found.several, acts);

  FourRows change = pc_sub4(now.normal, found.impulse);
  Push push = pc_push(PC_PASS m, change.r0, change.r1, change.r2, change.r3);
  Wrench w = pc_wrench(n, t1, t2, push, now.friction.change1, now.friction.change2, now.friction.change_twist);
  Real touch = pc_touch(PC_PASS m, found.load, pc_sum4(now.normal));
  Visit r;
  r.impulse = w.impulse;
  r.couple = w.couple;
  // what a bounce leaves is to be read whole (synchronise)
  r.touch = pc_select(thrown > PC_REAL(0.0), pc_max(touch, push.n), touch);
  r.room = now.room;
  return r;
}
