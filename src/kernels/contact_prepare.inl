// Once a step: the rows of a manifold. Effective masses and responses between its rows, from the inertia at
// the start of the step (so the solver touches each body once per visit; docs/impulses.md).
#include "body_state.inl"
#include "contact_rows.inl"
#include "contact_masses.inl"
#include "free_responses.inl"

// A gap without what rounding has in it: of a difference of lengths so large nothing below `noise` is known, and at steps of
// 1e-4 s the speed that would close it in one is as large as what gravity makes.
PC_FN Real pc_extent(Vec3 arm) { precise Real r = pc_abs(arm.x) + pc_abs(arm.y) + pc_abs(arm.z); return r; }
PC_FN Real pc_told_gap(Real s, Real noise) { precise Real r = s - pc_clamp(s, -noise, noise); return r; }

// Of the way that two bodies move apart along the contact plane, what a's arm takes. A ball's point stays under its centre, whatever it
// rolls on; two balls divide the way by their radii; else the light body keeps its point (pc_arms).
PC_FN Mask pc_is_under(Vec3 arm, Vec3 n) { Vec3 off = pc_cross(arm, n); precise Real most = pc_dot(arm, arm) * PC_REAL(1e-6); return pc_dot(off, off) < most; }
PC_FN Real pc_rolling_share(Vec3 arm_a, Vec3 arm_b, Vec3 n, Real light_a) {
  Mask ball_a = pc_is_under(arm_a, n); Mask ball_b = pc_is_under(arm_b, n);
  Real ra = pc_abs(pc_dot(arm_a, n)); Real rb = pc_abs(pc_dot(arm_b, n)); precise Real both = ra + rb; precise Real by_radius = ra * pc_inverse_or_zero(both);
  Real only_b = pc_select(ball_b, PC_REAL(1.0), light_a); Real with_a = pc_select(ball_b, by_radius, PC_REAL(0.0)); return pc_select(ball_a, with_a, only_b);
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u); Index ib = PC_ENDS(contact_ends, m, 1u); Index record = PC_ORDER(contact_order, m);
  Quad head = PC_GATHER(contact, record, 0u);
  Quad p0 = PC_GATHER(contact, record, 1u); Quad p1 = PC_GATHER(contact, record, 2u); Quad p2 = PC_GATHER(contact, record, 3u); Quad p3 = PC_GATHER(contact, record, 4u);
  Quad pushes = PC_GATHER(contact, record, 5u); Quad mean = PC_GATHER(contact, record, 8u); Quad material = PC_GATHER(contact, record, 7u);
  Quad place_a = PC_GATHER(pose, ia, 0u); Quad place_b = PC_GATHER(pose, ib, 0u); Quad low_a = PC_GATHER(pose, ia, 2u); Quad low_b = PC_GATHER(pose, ib, 2u);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Real zero = PC_REAL(0.0); Real one = PC_REAL(1.0);

  // contact frame
  Vec3 n = head.v; Real count = head.s;
  Mask steep = pc_abs(n.x) < PC_REAL(0.57);
  Vec3 e = Vec3(pc_select(steep, one, zero), pc_select(steep, zero, one), zero);
  Vec3 t1 = pc_unit_or_zero(pc_madd(e, n, -pc_dot(e, n))); Vec3 t2 = pc_cross(n, t1);

  // centre, and the points about it; a missing point has weight zero
  Real w0 = pc_select(count > PC_REAL(0.5), one, zero); Real w1 = pc_select(count > PC_REAL(1.5), one, zero);
  Real w2 = pc_select(count > PC_REAL(2.5), one, zero); Real w3 = pc_select(count > PC_REAL(3.5), one, zero);
  Real share = pc_inverse_or_zero(count);
  precise Vec3 ra = (p0.v * w0 + p1.v * w1 + p2.v * w2 + p3.v * w3) * share;
  Vec3 apart = pc_add(pc_sub(place_a.v, place_b.v), pc_sub(low_a.v, low_b.v));
  // effective masses are those of the arms at impact, which pc_arms gives when the bodies have come so far
  precise Real k = a.inverse_mass + b.inverse_mass; precise Real light_a = b.inverse_mass * pc_inverse_or_zero(k);
  Real flight = pc_max(material.s, PC_REAL(0.0));
  precise Vec3 path = (b.v - a.v) * flight;
  Vec3 start_a = ra; Vec3 start_b = pc_add(ra, apart);
  Mask stays = pc_or(count > PC_REAL(1.5), pc_or(flight > zero, pc_min(a.inverse_mass, b.inverse_mass) < PC_TINY));
  Real share_a = pc_select(stays, light_a, pc_rolling_share(start_a, start_b, n, light_a)); precise Real rest_a = share_a - PC_REAL(1.0);
  ra = pc_madd(start_a, path, share_a); Vec3 rb = pc_madd(start_b, path, rest_a);
  Vec3 d0 = pc_sub(p0.v, start_a); Vec3 d1 = pc_sub(p1.v, start_a); Vec3 d2 = pc_sub(p2.v, start_a); Vec3 d3 = pc_sub(p3.v, start_a);
  precise Real a0 = pc_dot(d0, t1) * w0; precise Real b0 = pc_dot(d0, t2) * w0;
  precise Real a1 = pc_dot(d1, t1) * w1; precise Real b1 = pc_dot(d1, t2) * w1;
  precise Real a2 = pc_dot(d2, t1) * w2; precise Real b2 = pc_dot(d2, t2) * w2;
  precise Real a3 = pc_dot(d3, t1) * w3; precise Real b3 = pc_dot(d3, t2) * w3;

  Responses r = pc_free_responses(a, b, ra, rb, n, t1, t2);

  precise Real spread = (a0 * a0 + b0 * b0 + a1 * a1 + b1 * b1 + a2 * a2 + b2 * b2 + a3 * a3 + b3 * b3) * share; Real radius = pc_sqrt(spread);

  // approach of each point, for restitution
  Vec3 wa = pc_angular_velocity(a); Vec3 wb = pc_angular_velocity(b);
  Vec3 va = pc_add(a.v, pc_cross(wa, ra)); Vec3 vb = pc_add(b.v, pc_cross(wb, rb));
  Real vn = pc_dot(n, pc_sub(vb, va)); Real r1 = pc_dot(t1, pc_sub(wb, wa)); Real r2 = pc_dot(t2, pc_sub(wb, wa));
  precise Real approach0 = vn + b0 * r1 - a0 * r2;
  precise Real approach1 = vn + b1 * r1 - a1 * r2;
  precise Real approach2 = vn + b2 * r1 - a2 * r2;
  precise Real approach3 = vn + b3 * r1 - a3 * r2;

  pc_st3_rows(PC_PASS m, ROW_N, n); pc_st3_rows(PC_PASS m, ROW_T, t1); pc_st3_rows(PC_PASS m, ROW_ARM_A, start_a); pc_st3_rows(PC_PASS m, ROW_ARM_B, start_b);
  PC_ST(contact_rows, m, ROW_A, a0); PC_ST(contact_rows, m, ROW_A + 1u, a1); PC_ST(contact_rows, m, ROW_A + 2u, a2); PC_ST(contact_rows, m, ROW_A + 3u, a3);
  PC_ST(contact_rows, m, ROW_B, b0); PC_ST(contact_rows, m, ROW_B + 1u, b1); PC_ST(contact_rows, m, ROW_B + 2u, b2); PC_ST(contact_rows, m, ROW_B + 3u, b3);
  // missing points take the mean gap of the others, so that none is the nearest
  precise Real gap = (p0.s * w0 + p1.s * w1 + p2.s * w2 + p3.s * w3) * share;
  precise Real reach = pc_extent(start_a) + pc_extent(start_b) + radius; precise Real rounding = reach * PC_INFO(gap_rounding);
  Real noise = pc_select(pc_or(flight > zero, material.v.z > zero), zero, rounding);  // (of what bounces the instant counts)
  PC_ST(contact_rows, m, ROW_S, pc_told_gap(p0.s, noise)); PC_ST(contact_rows, m, ROW_S + 1u, pc_told_gap(pc_select(w1 > zero, p1.s, gap), noise));
  PC_ST(contact_rows, m, ROW_S + 2u, pc_told_gap(pc_select(w2 > zero, p2.s, gap), noise)); PC_ST(contact_rows, m, ROW_S + 3u, pc_told_gap(pc_select(w3 > zero, p3.s, gap), noise));
  pc_store_masses(PC_PASS m, r, w0, w1, w2, w3);
#ifndef PC_FRICTIONLESS
  PC_ST(contact_rows, m, ROW_MU_STATIC, material.v.x);
  PC_ST(contact_rows, m, ROW_MU_KINETIC, material.v.y);
  PC_ST(contact_rows, m, ROW_RADIUS, radius);
#endif
  PC_ST(contact_rows, m, ROW_E, material.v.z);
  PC_ST(contact_rows, m, ROW_APPROACH, pc_min(approach0, zero)); PC_ST(contact_rows, m, ROW_APPROACH + 1u, pc_min(approach1, zero)); PC_ST(contact_rows, m, ROW_APPROACH + 2u, pc_min(approach2, zero)); PC_ST(contact_rows, m, ROW_APPROACH + 3u, pc_min(approach3, zero));

  PC_ST(contact_rows, m, ROW_IMPACT, material.s); PC_ST(contact_rows, m, ROW_SCALE, one);
  PC_ST(contact_rows, m, ROW_SHARE, share_a); pc_st3_rows(PC_PASS m, ROW_PATH, path);
  PC_ST(contact_rows, m, ROW_K, pc_select(flight > zero, zero, PC_LD(contact_rows, m, ROW_K)));

  // remembered impulses; they scale with the sub-step
  Real ratio = PC_INFO(impulse_ratio);
  precise Real l0 = pushes.v.x * w0 * ratio; precise Real l1 = pushes.v.y * w1 * ratio; precise Real l2 = pushes.v.z * w2 * ratio; precise Real l3 = pushes.s * w3 * ratio;
  PC_ST(contact_impulses, m, 0u, l0); PC_ST(contact_impulses, m, 1u, l1); PC_ST(contact_impulses, m, 2u, l2); PC_ST(contact_impulses, m, 3u, l3);
#ifndef PC_FRICTIONLESS
  Quad drag = PC_GATHER(contact, record, 6u);
  precise Real f1 = pc_dot(t1, drag.v) * w0 * ratio; precise Real f2 = pc_dot(t2, drag.v) * w0 * ratio; precise Real ft = drag.s * w0 * ratio;
  PC_ST(contact_impulses, m, IMPULSE_T, f1); PC_ST(contact_impulses, m, IMPULSE_T + 1u, f2); PC_ST(contact_impulses, m, IMPULSE_T + 2u, ft);
#endif
  PC_ST(contact_impulses, m, IMPULSE_LARGEST, zero); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 1u, zero); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 2u, zero); PC_ST(contact_impulses, m, IMPULSE_LARGEST + 3u, zero);
  precise Real load = l0 + l1 + l2 + l3; PC_ST(contact_impulses, m, IMPULSE_BEFORE, load);
  precise Vec3 means = mean.v * ratio; precise Real last_mean = mean.s * ratio;
  PC_ST(contact_impulses, m, IMPULSE_MEAN, means.x); PC_ST(contact_impulses, m, IMPULSE_MEAN + 1u, means.y); PC_ST(contact_impulses, m, IMPULSE_MEAN + 2u, means.z); PC_ST(contact_impulses, m, IMPULSE_MEAN + 3u, last_mean);
}
