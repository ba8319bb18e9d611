// contact_warm with bodies of trees: their impulses go into the solve of the tree (tree_collect),
// as it would answer them.
#include "tree_math.inl"
#include "contact_way.inl"
#include "node_push.inl"
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_warming.inl"
#include "contact_shift.inl"
#include "contact_meeting.inl"
#include "tree_reach.inl"
#include "row_approach.inl"
#include "contact_recalled.inl"

// How fast rows that may bounce approach before anything remembered acts:
// what that drives together has not come together.
PC_FN void pc_keep_approach(PC_IO Way w, Slot m, Index ia, Index ib) {
  if (!PC_ANY(PC_LD(contact_rows, m, ROW_E) > PC_REAL(0.0))) return;  // lint: allow (others have no use for it)
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Meeting now = pc_meeting(PC_PASS m, ia, ib, n, t1, pc_cross(n, t1));
  Real fastest = PC_REAL(0.0);
  for (uint i = 0u; i < 4u; i++) {
    Mask real = PC_LD(contact_rows, m, ROW_MASS + i) > PC_REAL(0.0);
    fastest = pc_select(real, pc_min(fastest, pc_row_approach(PC_PASS m, i, now.twist)), fastest);
  }
  PC_ST(contact_reach, PC_NODE(m, w.reach), REACH_APPROACH, fastest);
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Way w = pc_way(PC_PASS m);
  Real zero = PC_REAL(0.0);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY));
  Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  pc_keep_approach(PC_PASS w, m, ia, ib);
  Mask all = zero < PC_REAL(1.0);
  pc_keep_recalled(PC_PASS m, ia, ib, all);
  Wrench wrench = pc_warm_start(PC_PASS m, all);
  Real size = pc_max(pc_largest(wrench.impulse), pc_largest(wrench.couple));
  Mask some = size > zero;
  if (!PC_ANY(some)) return;  // lint: allow (nothing changes nothing)
  wrench.impulse = pc_select3(some, wrench.impulse, pc_zero3());
  wrench.couple = pc_select3(some, wrench.couple, pc_zero3());
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  Vec3 torque_a = pc_select3(some, pc_moment(wrench.couple, arms.a, wrench.impulse), pc_zero3());
  Vec3 torque_b = pc_select3(some, pc_moment(wrench.couple, arms.b, wrench.impulse), pc_zero3());
  Mask tree_a = pc_in_tree(PC_PASS w, m, 0u);
  Mask tree_b = pc_in_tree(PC_PASS w, m, 1u);
  Quad linear_a = PC_GATHER(motion, ia, 0u);
  Quad linear_b = PC_GATHER(motion, ib, 0u);
  Mask free = pc_max(pc_select(tree_a, zero, linear_a.s), pc_select(tree_b, zero, linear_b.s)) > zero;
  if (PC_ANY(free)) {  // lint: allow (bodies of trees and those that stand keep their rows)
    BodyState a = pc_body_state(PC_PASS ia);
    BodyState b = pc_body_state(PC_PASS ib);
    pc_apply_free(PC_PASS ia, ib, a, b, tree_a, tree_b, wrench.impulse, torque_a, torque_b);
  }
  pc_note_push(PC_PASS w, m, 0u, tree_a, pc_six(pc_negate(wrench.impulse), pc_negate(torque_a)), zero);
  pc_note_push(PC_PASS w, m, 1u, tree_b, pc_six(wrench.impulse, torque_b), zero);
}
