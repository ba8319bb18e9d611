// Once a sub-step, after tree_respond, and once more of what joints have sent together: how far the rows of a manifold
// with a body of a tree reach (tree_reach.inl), and their effective masses, from how whole trees answer.
#define PC_SOME_ROWS
#include "tree_math.inl"
#include "contact_way.inl"
#include "node_operator.inl"
#include "contact_rows.inl"
#include "body_state.inl"
#include "contact_arms.inl"
#include "contact_twist.inl"
#include "contact_shift.inl"
#include "contact_meeting.inl"
#include "contact_masses.inl"
#include "free_responses.inl"
#include "tree_reach.inl"
#include "reach_turning.inl"
#include "kept_meeting.inl"
#include "contact_reach.inl"
#include "row_approach.inl"

// Contacts that hold nothing, and whose points would come no nearer than the speeds of their bodies could close, are
// left alone in this sub-step: in a pile half of all. What is missed the next sub-step sees.
PC_FN Real pc_room(PC_IO Slot m, uint i, Twist v, Shift shift) {
  Real a = PC_LD(contact_rows, m, ROW_A + i);
  Real b = PC_LD(contact_rows, m, ROW_B + i);
  precise Real s = PC_LD(contact_rows, m, ROW_S + i) + (shift.n + b * shift.turn1 - a * shift.turn2);
  precise Real room = s * PC_INFO(inverse_h) + (v.vn + b * v.w1 - a * v.w2);
  return pc_select(PC_LD(contact_rows, m, ROW_MASS + i) > PC_REAL(0.0), room, PC_FAR);
}
PC_FN Mask pc_idles(PC_IO Slot m, Meeting now) {
  Real held = PC_REAL(0.0);
  for (uint i = 0u; i < 4u; i++) held = pc_max(held, PC_LD(contact_impulses, m, i));
  for (uint i = 0u; i < 3u; i++) held = pc_max(held, pc_abs(PC_LD(contact_impulses, m, IMPULSE_T + i)));
  Real room =
      pc_min(pc_min(pc_room(PC_PASS m, 0u, now.twist, now.shift), pc_room(PC_PASS m, 1u, now.twist, now.shift)),
             pc_min(pc_room(PC_PASS m, 2u, now.twist, now.shift), pc_room(PC_PASS m, 3u, now.twist, now.shift)));
  precise Real fast = pc_length(now.a.v) + pc_length(now.b.v);
  return pc_select(held > PC_REAL(0.0), PC_REAL(0.0), room) > fast;
}

PC_FN void pc_fill_reach(PC_IO Way w, Slot m, bool turns, Arms arms, Vec3 n, Vec3 t1, Vec3 t2) {
  Vec3 f1 = pc_negate(t1);
  Vec3 f2 = pc_negate(t2);
  Vec3 fn = pc_negate(n);
  Vec3 zero = pc_zero3();
  pc_reach(
      PC_PASS w, m, 0u, turns,
      pc_three(pc_six(f1, pc_cross(arms.a, f1)), pc_six(f2, pc_cross(arms.a, f2)), pc_six(fn, pc_cross(arms.a, fn))),
      pc_three(pc_six(zero, f1), pc_six(zero, f2), pc_six(zero, fn)));
  pc_reach(PC_PASS w, m, 1u, turns,
           pc_three(pc_six(t1, pc_cross(arms.b, t1)), pc_six(t2, pc_cross(arms.b, t2)), pc_six(n, pc_cross(arms.b, n))),
           pc_three(pc_six(zero, t1), pc_six(zero, t2), pc_six(zero, n)));
}
// Of both sides: what bodies of trees answer, on top of free ones.
PC_FN Responses pc_tree_responses(PC_IO Way w, Slot m, bool turns, Responses free) {
  Responses r = free;
  r.l = pc_sym_add(free.l, pc_answers(PC_PASS w, m, 0u));
  Mat3 mixed = pc_mat3(pc_zero3(), pc_zero3(), pc_zero3());
  if (turns) {  // lint: allow (others have no use for it)
    Mask turning = pc_turns_matter(PC_PASS m);
    Vec3 zero = pc_zero3();
    r.a = pc_sym_add(free.a, pc_answers(PC_PASS w, m, 1u));
    mixed = pc_mixed_answers(PC_PASS w, m);
    r.a = pc_sym_select(turning, r.a, free.a);
    mixed = pc_mat3(pc_select3(turning, mixed.a, zero), pc_select3(turning, mixed.b, zero),
                    pc_select3(turning, mixed.c, zero));
  }
  r.w1 = pc_add(free.w1, Vec3(mixed.a.x, mixed.b.x, mixed.c.x));
  r.w2 = pc_add(free.w2, Vec3(mixed.a.y, mixed.b.y, mixed.c.y));
  r.wn = pc_add(free.wn, Vec3(mixed.a.z, mixed.b.z, mixed.c.z));
  return r;
}
// What stands in no tree answers for itself.
PC_FN BodyState pc_outside(Mask in_tree, BodyState b) {
  Real zero = PC_REAL(0.0);
  b.inverse_mass = pc_select(in_tree, zero, b.inverse_mass);
  b.response = pc_select(in_tree, zero, b.response);
  return b;
}
PC_FN Responses pc_outside_responses(PC_IO Way w, Slot m, Meeting now, Vec3 n, Vec3 t1, Vec3 t2) {
  BodyState a = pc_outside(pc_in_tree(PC_PASS w, m, 0u), now.a);
  BodyState b = pc_outside(pc_in_tree(PC_PASS w, m, 1u), now.b);
  if (PC_ANY(pc_max(a.inverse_mass, b.inverse_mass) > PC_REAL(0.0))) {  // lint: allow (zeros otherwise)
    return pc_free_responses(a, b, now.arms.a, now.arms.b, n, t1, t2);
  }
  Responses r;
  r.l = pc_diagonal(PC_REAL(0.0));
  r.a = r.l;
  r.w1 = pc_zero3();
  r.w2 = r.w1;
  r.wn = r.w1;
  r.these = PC_REAL(1.0) > PC_REAL(0.0);
  return r;
}
// The approach that is told of a row (contact_touch) is that of the sub-step in which it first pushes: on its way there
// a limb is turned by blows elsewhere.
PC_FN void pc_see_approach(PC_IO Slot m, uint i, Twist v, Mask these) {
  Real u = pc_row_approach(PC_PASS m, i, v);
  Mask waits = pc_and(these, PC_LD(contact_impulses, m, IMPULSE_LARGEST + i) < PC_TINY);
  PC_ST(contact_rows, m, ROW_APPROACH + i,
        pc_select(waits, pc_min(u, PC_REAL(0.0)), PC_LD(contact_rows, m, ROW_APPROACH + i)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Real one = PC_REAL(1.0);
  Real none = PC_REAL(0.0);
  Real acted = PC_LD(contact_rows, m, ROW_ACTS);
  Mask these = pc_or(PC_INFO(sent) < PC_REAL(0.5), acted > one);
  if (!PC_ANY(these)) return;  // lint: allow (others keep what they have)
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY));
  Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  Meeting now = pc_meeting(PC_PASS m, ia, ib, n, t1, t2);
  for (uint i = 0u; i < 4u; i++) pc_see_approach(PC_PASS m, i, now.twist, these);
  precise Real acts = PC_INFO(sent) + one;
  Real acting = pc_select(pc_idles(PC_PASS m, now), none, acts);
  PC_ST(contact_rows, m, ROW_ACTS, pc_select(these, acting, acted));
  these = pc_and(these, acting > none);
  if (!PC_ANY(these)) return;  // lint: allow (rows that are left alone use none of what follows)
  pc_keep_meeting(PC_PASS w, m, now, these);
  bool turns = PC_ANY(pc_turns_matter(PC_PASS m));
  pc_fill_reach(PC_PASS w, m, turns, now.arms, n, t1, t2);
  Responses r = pc_tree_responses(PC_PASS w, m, turns, pc_outside_responses(PC_PASS w, m, now, n, t1, t2));
  Real w0 = pc_select(PC_LD(contact_rows, m, ROW_MASS) > none, one, none);
  Real w1 = pc_select(PC_LD(contact_rows, m, ROW_MASS + 1u) > none, one, none);
  Real w2 = pc_select(PC_LD(contact_rows, m, ROW_MASS + 2u) > none, one, none);
  Real w3 = pc_select(PC_LD(contact_rows, m, ROW_MASS + 3u) > none, one, none);
  r.these = these;
  pc_store_masses(PC_PASS m, r, w0, w1, w2, w3);
}
#undef PC_SOME_ROWS
