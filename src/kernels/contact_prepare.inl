// The rows of a manifold that was found anew in this sub-step: effective masses and responses between its rows, from
// the inertia of now (so the solver touches each body once per visit; docs/impulses.md). Others keep theirs.
#define PC_SOME_ROWS
#include "body_state.inl"
#include "contact_rows.inl"
#include "contact_masses.inl"
#include "contact_together.inl"
#include "free_responses.inl"
#include "contact_arms.inl"
#include "contact_twist.inl"
#include "contact_shift.inl"

// A gap without what rounding has in it: of a difference of lengths so large nothing below `noise` is known, and at
// steps of 1e-4 s the speed that would close it in one is as large as what gravity makes.
PC_FN Real pc_told_gap(Real s, Real noise) {
  precise Real r = s - pc_clamp(s, -noise, noise);
  return r;
}
PC_FN Real pc_extent(Vec3 arm) {
  precise Real r = pc_abs(arm.x) + pc_abs(arm.y) + pc_abs(arm.z);
  return r;
}
// (of what bounces, and of what meets in flight, the instant counts)
PC_FN Real pc_noise(Arms arms, Real radius, Quad material) {
  precise Real reach = pc_extent(arms.a) + pc_extent(arms.b) + radius;
  precise Real rounding = reach * PC_EPSILON;
  Mask instant = pc_or(material.s > PC_REAL(0.0), material.v.z > PC_REAL(0.0));
  return pc_select(instant, PC_REAL(0.0), rounding);
}

// Of the way that two bodies move apart along the contact plane, what a's arm takes. A ball's point stays under its
// centre, whatever it rolls on; two balls divide the way by their radii; else the light body keeps its point (pc_arms).
PC_FN Mask pc_is_under(Vec3 arm, Vec3 n) {
  Vec3 off = pc_cross(arm, n);
  precise Real most = pc_dot(arm, arm) * PC_SLIGHT;
  return pc_dot(off, off) < most;
}
PC_FN Real pc_rolling_share(Vec3 arm_a, Vec3 arm_b, Vec3 n, Real light_a) {
  Mask ball_a = pc_is_under(arm_a, n);
  Mask ball_b = pc_is_under(arm_b, n);
  Real ra = pc_abs(pc_dot(arm_a, n));
  Real rb = pc_abs(pc_dot(arm_b, n));
  precise Real both = ra + rb;
  precise Real by_radius = ra * pc_inverse_or_zero(both);
  Real only_b = pc_select(ball_b, PC_REAL(1.0), light_a);
  Real with_a = pc_select(ball_b, by_radius, PC_REAL(0.0));
  return pc_select(ball_a, with_a, only_b);
}

// ---- the manifold as it was found ---------------------------------------------------------------------
// Whose rows are made anew.
struct Anew {
  Mask all;      // what was found anew
  Mask rows;     // and of it, what does not keep the rows that it had
  Mask of_step;  // the step begins
  Mask over;     // they came apart
};

// The contact frame.
struct Frame {
  Vec3 n;
  Vec3 t1;
  Vec3 t2;
};
PC_FN Frame pc_frame(Vec3 n) {
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  Mask steep = pc_abs(n.x) < PC_STEEP;
  Vec3 e = Vec3(pc_select(steep, one, zero), pc_select(steep, zero, one), zero);
  Frame f;
  f.n = n;
  f.t1 = pc_unit_or_zero(pc_madd(e, n, -pc_dot(e, n)));
  f.t2 = pc_cross(n, f.t1);
  return f;
}

// Places from body a, and gaps. A missing point has weight zero, the others have one.
struct Points {
  Quad p0;
  Quad p1;
  Quad p2;
  Quad p3;
  FourRows weight;
  Real share;  // of each in their mean
};
PC_FN Points pc_points(PC_IO Index record, Real count) {
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  precise Real past_two = count - PC_REAL(2.0);
  Points p;
  p.p0 = PC_GATHER(contact, record, 1u);
  p.p1 = PC_GATHER(contact, record, 2u);
  p.p2 = PC_GATHER(contact, record, 3u);
  p.p3 = PC_GATHER(contact, record, 4u);
  p.weight = pc_four(pc_select(count > PC_REAL(0.5), one, zero), pc_select(count > one, one, zero),
                     pc_select(past_two > zero, one, zero), pc_select(past_two > one, one, zero));
  p.share = pc_inverse_or_zero(count);
  return p;
}
// The centre, and the mean gap.
PC_FN Quad pc_mean(Points p) {
  FourRows w = p.weight;
  precise Vec3 centre = (p.p0.v * w.r0 + p.p1.v * w.r1 + p.p2.v * w.r2 + p.p3.v * w.r3) * p.share;
  precise Real gap = (p.p0.s * w.r0 + p.p1.s * w.r1 + p.p2.s * w.r2 + p.p3.s * w.r3) * p.share;
  return pc_quad(centre, gap);
}

// Arms to the centre as found; those at impact, which pc_arms gives when the bodies have come so far, and which
// effective masses are of; b's way against a until then, and what a's arm takes of it.
struct FoundArms {
  Arms start;
  Arms impact;
  Vec3 path;
  Real share;
};
PC_FN FoundArms pc_found_arms(BodyState a, BodyState b, Vec3 centre, Vec3 apart, Vec3 n, Real count, Real flight) {
  FoundArms r;
  r.start.a = centre;
  r.start.b = pc_add(centre, apart);
  precise Real k = a.inverse_mass + b.inverse_mass;
  precise Real light_a = b.inverse_mass * pc_inverse_or_zero(k);
  precise Vec3 path = (b.v - a.v) * flight;
  Mask stays =
      pc_or(count > PC_REAL(1.0), pc_or(flight > PC_REAL(0.0), pc_min(a.inverse_mass, b.inverse_mass) < PC_TINY));
  Real share = pc_select(stays, light_a, pc_rolling_share(r.start.a, r.start.b, n, light_a));
  precise Real rest = share - PC_REAL(1.0);
  r.impact.a = pc_madd(r.start.a, path, share);
  r.impact.b = pc_madd(r.start.b, path, rest);
  r.path = path;
  r.share = share;
  return r;
}

// Where the points are about the centre, along t1 and t2.
struct Places {
  FourRows a;
  FourRows b;
};
PC_FN FourRows pc_along(Points p, Vec3 centre, Vec3 axis) {
  precise Real r0 = pc_dot(pc_sub(p.p0.v, centre), axis) * p.weight.r0;
  precise Real r1 = pc_dot(pc_sub(p.p1.v, centre), axis) * p.weight.r1;
  precise Real r2 = pc_dot(pc_sub(p.p2.v, centre), axis) * p.weight.r2;
  precise Real r3 = pc_dot(pc_sub(p.p3.v, centre), axis) * p.weight.r3;
  return pc_four(r0, r1, r2, r3);
}
PC_FN Places pc_places(Points p, Vec3 centre, Frame f) {
  Places at;
  at.a = pc_along(p, centre, f.t1);
  at.b = pc_along(p, centre, f.t2);
  return at;
}
PC_FN Real pc_radius(Places at, Real share) {
  FourRows a = at.a;
  FourRows b = at.b;
  precise Real spread =
      (a.r0 * a.r0 + b.r0 * b.r0 + a.r1 * a.r1 + b.r1 * b.r1 + a.r2 * a.r2 + b.r2 * b.r2 + a.r3 * a.r3 + b.r3 * b.r3) *
      share;
  return pc_sqrt(spread);
}
// What all points see of a motion of the centre (pc_seen_at).
PC_FN FourRows pc_seen_by_all(Vec3 motion, Places at) {
  return pc_four(pc_seen_at(motion, at.a.r0, at.b.r0), pc_seen_at(motion, at.a.r1, at.b.r1),
                 pc_seen_at(motion, at.a.r2, at.b.r2), pc_seen_at(motion, at.a.r3, at.b.r3));
}
// Gaps less what `shift` says of them. Missing points take the mean gap of the others, so that none is the nearest.
PC_FN FourRows pc_told_gaps(Points p, Real mean, Real noise, FourRows shift) {
  Real zero = PC_REAL(0.0);
  precise Real s0 = pc_told_gap(p.p0.s, noise) - shift.r0;
  precise Real s1 = pc_told_gap(pc_select(p.weight.r1 > zero, p.p1.s, mean), noise) - shift.r1;
  precise Real s2 = pc_told_gap(pc_select(p.weight.r2 > zero, p.p2.s, mean), noise) - shift.r2;
  precise Real s3 = pc_told_gap(pc_select(p.weight.r3 > zero, p.p3.s, mean), noise) - shift.r3;
  return pc_four(s0, s1, s2, s3);
}

// ---- its rows -----------------------------------------------------------------------------------------
PC_FN void pc_st_new(PC_IO Slot m, Mask these, uint f, Real x) {
  PC_ST(contact_rows, m, f, pc_select(these, x, PC_LD(contact_rows, m, f)));
}
PC_FN void pc_st3_new(PC_IO Slot m, Mask these, uint f, Vec3 v) {
  pc_st_new(PC_PASS m, these, f, v.x);
  pc_st_new(PC_PASS m, these, f + 1u, v.y);
  pc_st_new(PC_PASS m, these, f + 2u, v.z);
}
PC_FN void pc_st4_new(PC_IO Slot m, Mask these, uint f, FourRows x) {
  pc_st_new(PC_PASS m, these, f, x.r0);
  pc_st_new(PC_PASS m, these, f + 1u, x.r1);
  pc_st_new(PC_PASS m, these, f + 2u, x.r2);
  pc_st_new(PC_PASS m, these, f + 3u, x.r3);
}

// Rows go by the motion since the step began (pc_arms, pc_shift_of), less what there was of it: `gone`.
PC_FN void pc_store_arms(PC_IO Slot m, Mask these, Frame f, FoundArms arms, Vec3 gone) {
  pc_st3_new(PC_PASS m, these, ROW_N, f.n);
  pc_st3_new(PC_PASS m, these, ROW_T, f.t1);
  pc_st_new(PC_PASS m, these, ROW_SHARE, arms.share);
  pc_st3_new(PC_PASS m, these, ROW_ARM_A, arms.impact.a);
  pc_st3_new(PC_PASS m, these, ROW_ARM_B, arms.impact.b);
  pc_st3_new(PC_PASS m, these, ROW_PATH, pc_add(gone, arms.path));
}

// How they act; masses are stored before it.
PC_FN void pc_store_ways(PC_IO Slot m, Anew anew, Quad material, Real weight) {
  Real zero = PC_REAL(0.0);
  Mask flies = material.s > zero;
  Mask bounces = pc_and(flies, material.v.z > zero);
  // contact_solve leaves alone what has no point; of what meets within the sub-step, and does not bounce, it stops the
  // approach that contact_impact leaves
  Real acts = pc_select(pc_or(anew.over, bounces), zero, weight);
  pc_st_new(PC_PASS m, anew.all, ROW_K, pc_select(acts > zero, PC_LD(contact_rows, m, ROW_K), zero));
  pc_st_new(PC_PASS m, anew.rows, ROW_E, material.v.z);
  Mask unjointed = material.s > PC_REAL(-0.5);
  pc_st_new(PC_PASS m, anew.all, ROW_IMPACT, pc_select(pc_and(anew.over, unjointed), PC_REAL(-2.0), material.s));
  precise Real sent = PC_INFO(sent) * PC_REAL(2.0);
  // 0 as ROW_MET: they have not met
  pc_st_new(PC_PASS m, anew.rows, ROW_ACTS, pc_select(flies, zero, pc_select(anew.of_step, PC_REAL(1.0), sent)));
}

// How fast a point approached, for restitution: the fastest of the step.
// What contact_impact has put in its place stays.
PC_FN void pc_keep_approach(PC_IO Slot m, uint i, Anew anew, Real approach) {
  Real before = pc_select(anew.of_step, PC_REAL(0.0), PC_LD(contact_rows, m, ROW_APPROACH + i));
  Real fastest = pc_min(pc_min(approach, PC_REAL(0.0)), before);
  pc_st_new(PC_PASS m, anew.rows, ROW_APPROACH + i, pc_select(before > PC_REAL(0.0), before, fastest));
}
PC_FN void pc_keep_approaches(PC_IO Slot m, Anew anew, FourRows approach) {
  pc_keep_approach(PC_PASS m, 0u, anew, approach.r0);
  pc_keep_approach(PC_PASS m, 1u, anew, approach.r1);
  pc_keep_approach(PC_PASS m, 2u, anew, approach.r2);
  pc_keep_approach(PC_PASS m, 3u, anew, approach.r3);
}

// ---- its impulses -------------------------------------------------------------------------------------
// Those of the step before, which scale with the sub-step; or those that the rows hold.
PC_FN void pc_st_pushes(PC_IO Slot m, Mask these, uint f, Real x) {
  PC_ST(contact_impulses, m, f, pc_select(these, x, PC_LD(contact_impulses, m, f)));
}
// What point `from` (from 1) of the rows held; 0 of none.
PC_FN Real pc_held_by(PC_IO Slot m, Real from) {
  Real r = pc_select(from > PC_REAL(0.5), PC_LD(contact_impulses, m, 0u), PC_REAL(0.0));
  r = pc_select(from > PC_REAL(1.0), PC_LD(contact_impulses, m, 1u), r);
  r = pc_select(from > PC_REAL(2.0), PC_LD(contact_impulses, m, 2u), r);
  precise Real past_two = from - PC_REAL(2.0);
  return pc_select(past_two > PC_REAL(1.0), PC_LD(contact_impulses, m, 3u), r);
}
PC_FN Real pc_first_impulse(PC_IO Slot m, Anew anew, Real told, Real from, Real weight) {
  precise Real scaled = told * PC_INFO(impulse_ratio);
  Real before = pc_select(anew.of_step, scaled, pc_held_by(PC_PASS m, from));
  precise Real impulse = before * pc_select(anew.over, PC_REAL(0.0), weight);
  return impulse;
}
PC_FN void pc_store_impulses(PC_IO Slot m, Anew anew, Quad told, Quad from, FourRows weight) {
  Real l0 = pc_first_impulse(PC_PASS m, anew, told.v.x, from.v.x, weight.r0);
  Real l1 = pc_first_impulse(PC_PASS m, anew, told.v.y, from.v.y, weight.r1);
  Real l2 = pc_first_impulse(PC_PASS m, anew, told.v.z, from.v.z, weight.r2);
  Real l3 = pc_first_impulse(PC_PASS m, anew, told.s, from.s, weight.r3);
  pc_st_pushes(PC_PASS m, anew.all, 0u, l0);
  pc_st_pushes(PC_PASS m, anew.all, 1u, l1);
  pc_st_pushes(PC_PASS m, anew.all, 2u, l2);
  pc_st_pushes(PC_PASS m, anew.all, 3u, l3);
  pc_st_pushes(PC_PASS m, anew.all, IMPULSE_LAST, l0);
  pc_st_pushes(PC_PASS m, anew.all, IMPULSE_LAST + 1u, l1);
  pc_st_pushes(PC_PASS m, anew.all, IMPULSE_LAST + 2u, l2);
  pc_st_pushes(PC_PASS m, anew.all, IMPULSE_LAST + 3u, l3);
  for (uint i = 0u; i < 4u; i++) pc_st_pushes(PC_PASS m, anew.of_step, IMPULSE_LARGEST + i, PC_REAL(0.0));
  precise Real load = l0 + l1 + l2 + l3;
  pc_st_pushes(PC_PASS m, anew.all, IMPULSE_BEFORE, load);
}
#ifndef PC_FRICTIONLESS
// Of the frame that the rows hold, as a world vector.
PC_FN Vec3 pc_held_friction(PC_IO Slot m) {
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(pc_ld3_rows(PC_PASS m, ROW_N), t1);
  precise Vec3 held = t1 * PC_LD(contact_impulses, m, IMPULSE_T) + t2 * PC_LD(contact_impulses, m, IMPULSE_T + 1u);
  return held;
}
PC_FN void pc_store_friction(PC_IO Slot m, Anew anew, Frame f, Quad told, Vec3 held, Quad from, Real weight) {
  Real zero = PC_REAL(0.0);
  Real ratio = PC_INFO(impulse_ratio);
  precise Vec3 dragged = told.v * ratio;
  precise Real twisted = told.s * ratio;
  Vec3 friction = pc_select3(anew.of_step, dragged, held);
  Real twist = pc_select(anew.of_step, twisted, PC_LD(contact_impulses, m, IMPULSE_T + 2u));
  Mask known = pc_or(anew.of_step, pc_max(pc_max(from.v.x, from.v.y), pc_max(from.v.z, from.s)) > PC_REAL(0.5));
  Mask lasts = pc_select(known, pc_select(anew.over, zero, weight), zero) > zero;
  pc_st_pushes(PC_PASS m, anew.all, IMPULSE_T, pc_select(lasts, pc_dot(f.t1, friction), zero));
  pc_st_pushes(PC_PASS m, anew.all, IMPULSE_T + 1u, pc_select(lasts, pc_dot(f.t2, friction), zero));
  pc_st_pushes(PC_PASS m, anew.all, IMPULSE_T + 2u, pc_select(lasts, twist, zero));
}
#endif

PC_FN void pc_kernel(PC_IO Slot m) {
  Index record = PC_ORDER(contact_order, m);
  Quad seen = PC_GATHER(contact, record, 8u);
  Real zero = PC_REAL(0.0);
  Anew anew;
  anew.of_step = PC_INFO(begins) > PC_REAL(0.5);
  anew.all = pc_or(anew.of_step, seen.s > PC_REAL(0.5));
  if (!PC_ANY(anew.all)) return;  // lint: allow (rows stand)
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
  Quad head = PC_GATHER(contact, record, 0u);
  Quad material = PC_GATHER(contact, record, 7u);
  Quad from = PC_GATHER(contact, record, 9u);
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  // what came apart keeps the rows that it was struck by (contact_touch), but in trees,
  // where all rows with mass are solved
  Mask jointed = material.s < zero;
  anew.over = seen.s > PC_REAL(1.0);
  anew.rows = pc_and(anew.all, pc_or(anew.of_step, pc_or(jointed, seen.s < PC_REAL(2.0))));
  Mask these = anew.rows;
  Real count = pc_select(pc_and(anew.over, jointed), zero, head.s);

  Frame f = pc_frame(head.v);
  Points points = pc_points(PC_PASS record, count);
  Quad mean = pc_mean(points);
  FoundArms arms = pc_found_arms(a, b, mean.v, pc_negate(seen.v), f.n, count, pc_max(material.s, zero));
  Places at = pc_places(points, mean.v, f);
  Real radius = pc_radius(at, points.share);
  Twist v = pc_twist(a, b, arms.impact, f.n, f.t1, f.t2);
  Responses r = pc_free_responses(a, b, arms.impact.a, arms.impact.b, f.n, f.t1, f.t2);
  r.these = these;
#ifndef PC_FRICTIONLESS
  // (what the rows hold is of the frame before)
  Vec3 held = pc_held_friction(PC_PASS m);
#endif

  pc_store_arms(PC_PASS m, these, f, arms, pc_sub(moved_b.v, moved_a.v));
  Shift shift =
      pc_shift_of(PC_PASS m, f.n, f.t1, f.t2, moved_a, moved_b, PC_GATHER(delta, ia, 1u), PC_GATHER(delta, ib, 1u));
  pc_st4_new(PC_PASS m, these, ROW_A, at.a);
  pc_st4_new(PC_PASS m, these, ROW_B, at.b);
  FourRows shifts = pc_seen_by_all(Vec3(shift.n, shift.turn1, shift.turn2), at);
  pc_st4_new(PC_PASS m, these, ROW_S, pc_told_gaps(points, mean.s, pc_noise(arms.start, radius, material), shifts));
  pc_store_masses(PC_PASS m, r, points.weight.r0, points.weight.r1, points.weight.r2, points.weight.r3);
  pc_store_ways(PC_PASS m, anew, material, points.weight.r0);
  pc_keep_approaches(PC_PASS m, anew, pc_seen_by_all(Vec3(v.vn, v.w1, v.w2), at));
  pc_store_impulses(PC_PASS m, anew, PC_GATHER(contact, record, 5u), from, points.weight);
#ifndef PC_FRICTIONLESS
  pc_st_new(PC_PASS m, these, ROW_MU_STATIC, material.v.x);
  pc_st_new(PC_PASS m, these, ROW_MU_KINETIC, material.v.y);
  pc_st_new(PC_PASS m, these, ROW_RADIUS, radius);
  pc_store_friction(PC_PASS m, anew, f, PC_GATHER(contact, record, 6u), held, from, points.weight.r0);
#endif
}
#undef PC_SOME_ROWS
