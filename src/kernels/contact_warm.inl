// Start of a sub-step's impulses between free bodies: what lasts of the last ones acts again (warm start),
// at the present arms.
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_warming.inl"
#include "contact_turned.inl"
#include "contact_calming.inl"
#include "contact_low.inl"
#include "contact_recalled.inl"

// A row remembers its impulse, and each of its two visits in a sub-step adds to it: of a slow motion of many bodies it
// is a spring of 2 m / h^2. At rest it is one of rate / leak, which is more, and what is stiffer at rest than in motion
// makes energy: piles bounced for good. So where one body stands on another that moves, what the last sub-step changed
// in a row's impulse goes on by a share (heavy ball: B. Polyak, Some methods of speeding up the convergence of
// iteration methods, 1964), by no more than that share of the impulse.
PC_FN void pc_go_on(PC_IO Slot m, Real inverse_masses, Mask pushes) {
  Mask stands =
      pc_and(pushes, pc_and(inverse_masses > PC_REAL(0.0), PC_LD(contact_rows, m, ROW_MASS + 2u) > PC_REAL(0.0)));
  Real share = pc_select(stands, PC_INFO(soft_trend), PC_REAL(0.0));
  for (uint i = 0u; i < 4u; i++) {
    Real now = PC_LD(contact_impulses, m, i);
    Real before = PC_LD(contact_impulses, m, IMPULSE_LAST + i);
    precise Real change = now - before;
    precise Real most = pc_min(now, before);
    precise Real next = now + pc_clamp(change, -most, most) * share;
    PC_ST(contact_impulses, m, IMPULSE_LAST + i, pc_select(stands, now, before));
    PC_ST(contact_impulses, m, i, pc_select(stands, next, now));
  }
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Mask pushes = pc_pushes(PC_PASS m);
  if (!PC_ANY(pushes)) return;  // lint: allow (others change nothing)
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  Mask far = pc_or(pc_turns_far(PC_PASS a, moved_a), pc_turns_far(PC_PASS b, moved_b));
  // of one point: what meets by several turns by what each of them stops, and comes together elsewhere
  Mask met = pc_and(PC_LD(contact_rows, m, ROW_IMPACT) > PC_REAL(0.0), PC_LD(contact_rows, m, ROW_MET) > PC_REAL(0.0));
  met = pc_and(met, pc_mass_of_others(PC_PASS m) < PC_TINY);
  Real acts = pc_select(met, ACTS_MET, PC_REAL(1.0));
  PC_ST(contact_rows, m, ROW_ACTS, pc_select(pushes, acts, PC_LD(contact_rows, m, ROW_ACTS)));
  precise Real both_move = a.inverse_mass * b.inverse_mass;
  pc_go_on(PC_PASS m, both_move, pushes);
  pc_keep_recalled(PC_PASS m, ia, ib, pushes);
  Wrench w = pc_warm_start(PC_PASS m, pushes);
  if (PC_ANY(far)) {  // lint: allow (a share of one changes nothing)
    Real calming = pc_clamp(pc_calming_share(a, b, arms, w.impulse, w.couple), PC_REAL(0.0), PC_REAL(1.0));
    Real share = pc_select(pc_and(far, pushes), calming, PC_REAL(1.0));
    w.impulse = pc_scale(w.impulse, share);
    w.couple = pc_scale(w.couple, share);
    pc_keep_share(PC_PASS m, share);
  }
  pc_spare(a, pushes);
  pc_spare(b, pushes);
  pc_apply_low(PC_PASS ia, ib, a, b, arms, w.impulse, w.couple, pc_uneven(a, b));
}
