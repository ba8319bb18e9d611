// Manifolds of bodies that turn far within a step (pc_turns_far), so that their impulses take energy out and never put
// it in (docs/impulses.md). Before a sub-step's impulses: the effective masses at the present arms and inertia;
// remembered friction is dropped, and what rows that have come open remember: letting go of it later could feed energy
// in. Before the relax visit: the body has turned on, and masses, inertia and velocities are those of before, so the
// visit is left out.
#define PC_SOME_ROWS
#include "body_state.inl"
#include "contact_rows.inl"
#include "contact_arms.inl"
#include "contact_masses.inl"
#include "free_responses.inl"
#include "contact_turned.inl"
#include "contact_shift.inl"

PC_FN void pc_drop(PC_IO Slot m, uint i, Mask far) {
  PC_ST(contact_impulses, m, i, pc_select(far, PC_REAL(0.0), PC_LD(contact_impulses, m, i)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index ia = PC_ENDS(contact_ends, m, 0u);
  Index ib = PC_ENDS(contact_ends, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  Mask far = pc_or(pc_turns_far(PC_PASS a, moved_a), pc_turns_far(PC_PASS b, moved_b));
  if (!PC_ANY(far)) return;  // lint: allow (nothing to do otherwise)
  Real zero = PC_REAL(0.0);
  Mask flight = PC_LD(contact_rows, m, ROW_IMPACT) > zero;
  Vec3 none = pc_zero3();
  Vec3 path = pc_ld3_rows(PC_PASS m, ROW_PATH);
  Arms arms = pc_arms(PC_PASS m, pc_select3(flight, none, moved_a.v), pc_select3(flight, path, moved_b.v));
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  Responses r = pc_free_responses(a, b, arms.a, arms.b, n, t1, t2);
  r.these = far;
  pc_renew_masses(PC_PASS m, r);

  // (of the edge of a needle two points hold each other: one alone, and it spins)
  Shift shift = pc_shift_of(PC_PASS m, n, t1, t2, moved_a, moved_b, PC_GATHER(delta, ia, 1u), PC_GATHER(delta, ib, 1u));
  for (uint i = 0u; i < 4u; i++) {
    precise Real s = PC_LD(contact_rows, m, ROW_S + i) + (shift.n + PC_LD(contact_rows, m, ROW_B + i) * shift.turn1 -
                                                          PC_LD(contact_rows, m, ROW_A + i) * shift.turn2);
    pc_drop(PC_PASS m, i, pc_and(far, s > zero));
  }
  Mask relax = PC_INFO(load_ahead) > zero;
  // of a flight ROW_MET
  PC_ST(contact_rows, m, ROW_ACTS,
        pc_select(far, pc_select(pc_or(relax, flight), zero, PC_REAL(1.0)), PC_LD(contact_rows, m, ROW_ACTS)));
#ifndef PC_FRICTIONLESS
  pc_drop(PC_PASS m, IMPULSE_T, far);
  pc_drop(PC_PASS m, IMPULSE_T + 1u, far);
  pc_drop(PC_PASS m, IMPULSE_T + 2u, far);
#endif
}
#undef PC_SOME_ROWS
