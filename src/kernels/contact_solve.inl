// Visits a manifold between free bodies. The biased solve and the relax pass are this same text with other
// coefficients: relax has soft_rate 0, mass scale 1, impulse scale 0, so it removes the velocity that undoing an
// overlap put in (soft step: E. Catto, Solver2D, 2024).
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_visit.inl"
#include "contact_carried.inl"
#include "contact_blow.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Mask pushes = pc_and(pc_pushes(PC_PASS m), PC_LD(contact_rows, m, ROW_ACTS) > PC_REAL(0.0));
  if (!PC_ANY(pushes)) return;  // lint: allow (others change nothing)
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
#ifdef PC_PLACED
  pushes =
      pc_and(pushes, pc_max(PC_GATHER(velocity_parts, ia, 3u).s, PC_GATHER(velocity_parts, ib, 3u).s) > PC_REAL(0.0));
  if (!PC_ANY(pushes)) return;  // lint: allow (others keep what they have)
#endif
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  Shift shift = pc_shift_of(PC_PASS m, n, t1, t2, moved_a, moved_b, PC_GATHER(delta, ia, 1u), PC_GATHER(delta, ib, 1u));
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  // (between bodies that move there is none: balls that touch without an overlap meet anew in each sub-step)
  precise Real both = a.inverse_mass * b.inverse_mass;
  Real preload = pc_select(both > PC_REAL(0.0), PC_REAL(0.0), PC_INFO(contact_preload));
  // What has met in flight is seen at the instant at which it did, as contact_impact sees it (pc_impact_path): at an
  // earlier or later one the spins that the impact left would look like an approach, and a couple of the two visits
  // would stay.
  Mask met = PC_LD(contact_rows, m, ROW_ACTS) > PC_REAL(2.0);
  Arms seen;
  seen.a = pc_select3(met, pc_ld3_rows(PC_PASS m, ROW_ARM_A), arms.a);
  seen.b = pc_select3(met, pc_ld3_rows(PC_PASS m, ROW_ARM_B), arms.b);
  Twist now = pc_carried(PC_PASS pc_twist(a, b, seen, n, t1, t2), a, b, arms, t1, t2);
  // (none bounces here: what free bodies bounce is contact_impact's)
  Visit r = pc_visit(PC_PASS m, now, shift, n, t1, t2, preload, pushes, pc_no_rows());
  pc_spare(a, pushes);
  pc_spare(b, pushes);
  Mask blow = PC_LD(contact_rows, m, ROW_IMPACT) > PC_REAL(0.0);
  r.touch = pc_select(blow, PC_REAL(0.0), r.touch);
  // a fixed body's row stays as it is: slots beside each other may share it, and GL does not store it
  a.phase = pc_select(a.inverse_mass > PC_REAL(0.0), pc_max(a.phase, r.touch), a.phase);
  b.phase = pc_select(b.inverse_mass > PC_REAL(0.0), pc_max(b.phase, r.touch), b.phase);
  BodyState before_a = a;
  BodyState before_b = b;
  pc_apply(PC_PASS ia, ib, a, b, arms, r.impulse, r.couple);
  if (PC_ANY(blow)) {  // lint: allow (the same in lanes that are not)
    pc_count_blow(PC_PASS ia, pc_and(blow, a.inverse_mass > PC_REAL(0.0)), pc_sub(a.v, before_a.v),
                  pc_sub(a.l, before_a.l));
    pc_count_blow(PC_PASS ib, pc_and(blow, b.inverse_mass > PC_REAL(0.0)), pc_sub(b.v, before_b.v),
                  pc_sub(b.l, before_b.l));
  }
}
