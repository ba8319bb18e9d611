// What overlaps, of a manifold with a body of a tree, by more than its rows undo (tree_push_speed), is pushed apart for
// this one advance, at most at push_speed; tree_relax and push_back take these velocities back. The rows' impulses know
// nothing of it, and there is no friction: what undoes an overlap is no motion.
#define PC_TREES
#include "tree_math.inl"
#include "contact_way.inl"
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_together.inl"
#include "contact_shift.inl"
#include "contact_meeting.inl"
#include "tree_reach.inl"
#include "kept_meeting.inl"
#include "reach_motion.inl"

// What a row asks for, so that what is pushed leaves it the room it has, or makes what it lacks: at most at push_speed,
// and with no more energy than the lighter body has at that, or what can move only as others turn fast is flung about
// (docs/joint-trees.md).
PC_FN Real pc_row_push(PC_IO Way w, Slot m, uint i, Twist v, Real light) {
  precise Real vn = v.vn + PC_LD(contact_rows, m, ROW_B + i) * v.w1 - PC_LD(contact_rows, m, ROW_A + i) * v.w2;
  Real mass = PC_LD(contact_rows, m, ROW_MASS + i);
  precise Real least = mass * pc_min(mass, light);
  precise Real most = pc_sqrt(least) * PC_INFO(push_speed);
  Real room = pc_max(PC_LD(contact_reach, PC_NODE(m, w.reach + 1u), REACH_ROOM + i), -most);
  precise Real asked = -(mass * vn) - room;
  return pc_select(PC_LD(contact_rows, m, ROW_ACTS) > PC_REAL(0.0), pc_max(asked, PC_REAL(0.0)), PC_REAL(0.0));
}
// How a body in no tree has been pushed so far; others have what is pending.
PC_FN BodyState pc_push_state(PC_IO Index i, Mask free, BodyState b) {
  Quad impulse = PC_GATHER(pushed, i, 0u);
  Quad torque = PC_GATHER(pushed, i, 1u);
  b.v = pc_select3(free, pc_scale(impulse.v, b.inverse_mass), pc_zero3());
  b.l = pc_select3(free, pc_scale(torque.v, b.response), pc_zero3());
  return b;
}
PC_FN Twist pc_push_twist(PC_IO Index ia, Index ib, Mask free_a, Mask free_b, Meeting now, Vec3 n, Vec3 t1, Vec3 t2) {
  Real none = PC_REAL(0.0);
  Twist v;
  v.v1 = none;
  v.v2 = none;
  v.vn = none;
  v.w1 = none;
  v.w2 = none;
  v.wn = none;
  if (!PC_ANY(pc_or(free_a, free_b))) return v;  // lint: allow (zeros otherwise)
  return pc_twist(pc_push_state(PC_PASS ia, free_a, now.a), pc_push_state(PC_PASS ib, free_b, now.b), now.arms, n, t1,
                  t2);
}
// On a body in no tree; what is left of it once it has moved is push_back's.
PC_FN void pc_note_free(PC_IO Index i, Mask moves, Vec3 impulse, Vec3 torque) {
  Quad before = PC_GATHER(pushed, i, 0u);
  Quad turned = PC_GATHER(pushed, i, 1u);
  PC_SCATTER_IF(moves, pushed, i, 0u, pc_quad(pc_add(before.v, impulse), before.s));
  PC_SCATTER_IF(moves, pushed, i, 1u, pc_quad(pc_add(turned.v, torque), turned.s));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Mask acts = PC_LD(contact_rows, m, ROW_ACTS) > PC_REAL(0.0);
  if (!PC_ANY(acts)) return;  // lint: allow (others do nothing)
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY));
  Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  Meeting now = pc_meeting(PC_PASS m, ia, ib, n, t1, t2);
  Real none = PC_REAL(0.0);
  Mask tree_a = pc_in_tree(PC_PASS w, m, 0u);
  Mask tree_b = pc_in_tree(PC_PASS w, m, 1u);
  Mask free_a = pc_free_mass(tree_a, now.a) > none;
  Mask free_b = pc_free_mass(tree_b, now.b) > none;
  Mask turns = pc_and(acts, PC_LD(contact_rows, m, ROW_RADIUS) > none);  // rows of couples are set where one acts alone
  uint turning = PC_ANY(turns) ? pc_reach_all(w) : 0u;
  Twist v = pc_push_twist(PC_PASS ia, ib, free_a, free_b, now, n, t1, t2);
  Six rate = pc_with_pending(
      PC_PASS w, m, 1u, turning,
      pc_with_pending(PC_PASS w, m, 0u, turning, pc_six(Vec3(v.v1, v.v2, v.vn), Vec3(v.w1, v.w2, v.wn))));
  v.vn = rate.l.z;
  v.w1 = rate.a.x;
  v.w2 = rate.a.y;
  Real light = pc_inverse_or_zero(pc_max(now.a.inverse_mass, now.b.inverse_mass));
  Real e0 = pc_row_push(PC_PASS w, m, 0u, v, light);
  Real e1 = pc_row_push(PC_PASS w, m, 1u, v, light);
  Real e2 = pc_row_push(PC_PASS w, m, 2u, v, light);
  Real e3 = pc_row_push(PC_PASS w, m, 3u, v, light);
  Mask some = pc_max(pc_max(e0, e1), pc_max(e2, e3)) > PC_REAL(0.0);
  if (!PC_ANY(some)) return;  // lint: allow (nothing changes nothing)
  FourRows mass = pc_four(PC_LD(contact_rows, m, ROW_MASS), PC_LD(contact_rows, m, ROW_MASS + 1u),
                          PC_LD(contact_rows, m, ROW_MASS + 2u), PC_LD(contact_rows, m, ROW_MASS + 3u));
  Real share = pc_common_share(pc_four(none, none, none, none), pc_four(e0, e1, e2, e3), mass, pc_couplings(PC_PASS m));
  precise Real f0 = e0 * share;
  precise Real f1 = e1 * share;
  precise Real f2 = e2 * share;
  precise Real f3 = e3 * share;
  Push push = pc_push(PC_PASS m, f0, f1, f2, f3);
  Wrench f = pc_wrench(n, t1, t2, push, none, none, none);
  Vec3 impulse = pc_select3(some, f.impulse, pc_zero3());
  Vec3 couple = pc_select3(some, f.couple, pc_zero3());
  Vec3 torque_a = pc_moment(couple, now.arms.a, impulse);
  Vec3 torque_b = pc_moment(couple, now.arms.b, impulse);
  if (PC_ANY(pc_or(free_a, free_b))) {  // lint: allow (bodies of trees and those that stand keep theirs)
    pc_apply_free(PC_PASS ia, ib, now.a, now.b, tree_a, tree_b, impulse, torque_a, torque_b);
    pc_note_free(PC_PASS ia, free_a, pc_negate(impulse), pc_negate(torque_a));
    pc_note_free(PC_PASS ib, free_b, impulse, torque_b);
  }
  pc_push_trees(PC_PASS w, m, turning, t1, t2, n, impulse, couple, torque_a, torque_b, none);
}
#undef PC_TREES
