// Visits a manifold with a body of a tree, inside the space that the joints leave: what is pending in the trees moves
// the rows (tree_reach.inl), they are solved as those of free bodies are (contact_visit.inl), and the impulse goes into
// what is pending. The velocities of trees follow with tree_flush.
#define PC_TREES
#include "tree_math.inl"
#include "contact_way.inl"
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_visit.inl"
#include "contact_meeting.inl"
#include "tree_reach.inl"
#include "reach_turning.inl"
#include "kept_meeting.inl"
#include "reach_motion.inl"

// In the relax visit: with which speed a row is to leave that was pressed in this sub-step and approached fast as it
// began, before and after what is remembered acted.
PC_FN Real pc_leaves(PC_IO Slot m, uint i, Twist v, Real fastest) {
  Real approach = pc_max(pc_row_approach(PC_PASS m, i, v), fastest);
  precise Real threshold = -PC_INFO(restitution_threshold);
  Mask bounces = pc_and(PC_LD(contact_impulses, m, i) > PC_REAL(0.0), approach < threshold);
  precise Real back = -(PC_LD(contact_rows, m, ROW_E) * approach);
  return pc_select(bounces, back, PC_REAL(0.0));
}
PC_FN FourRows pc_bounce(PC_IO Way w, Slot m) {
  Real none = PC_REAL(0.0);
  Mask may = pc_and(PC_INFO(load_ahead) > PC_REAL(0.5), PC_LD(contact_rows, m, ROW_E) > none);
  if (!PC_ANY(may)) return pc_no_rows();  // lint: allow (zeros otherwise)
  Twist v = pc_kept_meeting(PC_PASS w, m).twist;
  Real fastest = pc_select(may, PC_LD(contact_reach, PC_NODE(m, w.reach), REACH_APPROACH), none);
  return pc_four(pc_leaves(PC_PASS m, 0u, v, fastest), pc_leaves(PC_PASS m, 1u, v, fastest),
                 pc_leaves(PC_PASS m, 2u, v, fastest), pc_leaves(PC_PASS m, 3u, v, fastest));
}

// The relax visit goes by rows of where the sub-step began. What has turned on by half a radian answers otherwise: by
// those rows it would gain energy.
PC_FN Mask pc_goes_by_rows(PC_IO Meeting now) {
  Vec3 wa = pc_angular_velocity(now.a);
  Vec3 wb = pc_angular_velocity(now.b);
  precise Real turned = pc_max(pc_dot(wa, wa), pc_dot(wb, wb)) * PC_INFO(h) * PC_INFO(h) * PC_INFO(load_ahead);
  // (a blow-up times zero is no number)
  return pc_select(PC_INFO(load_ahead) > PC_REAL(0.0), turned, PC_REAL(0.0)) < pc_quarter(PC_REAL(1.0));
}

// For tree_contact_push, which comes after the biased visit.
PC_FN void pc_keep_room(PC_IO Way w, Slot m, FourRows room, Mask acts) {
  if (PC_ANY(PC_INFO(load_ahead) > PC_REAL(0.5))) return;  // lint: allow (the same for all lanes)
  Slot s = PC_NODE(m, w.reach + 1u);
  PC_ST(contact_reach, s, REACH_ROOM, pc_select(acts, room.r0, PC_LD(contact_reach, s, REACH_ROOM)));
  PC_ST(contact_reach, s, REACH_ROOM + 1u, pc_select(acts, room.r1, PC_LD(contact_reach, s, REACH_ROOM + 1u)));
  PC_ST(contact_reach, s, REACH_ROOM + 2u, pc_select(acts, room.r2, PC_LD(contact_reach, s, REACH_ROOM + 2u)));
  PC_ST(contact_reach, s, REACH_ROOM + 3u, pc_select(acts, room.r3, PC_LD(contact_reach, s, REACH_ROOM + 3u)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Mask acts = PC_LD(contact_rows, m, ROW_ACTS) > PC_INFO(sent);
  if (!PC_ANY(acts)) return;  // lint: allow (others do nothing)
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY));
  Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N);
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(n, t1);
  Meeting now = pc_meeting_now(PC_PASS w, m, ia, ib, n, t1, t2);
  Twist v = now.twist;
  acts = pc_and(acts, pc_goes_by_rows(PC_PASS now));
  uint turning = pc_turning(PC_PASS w, m);
  Six rate = pc_with_pending(
      PC_PASS w, m, 1u, turning,
      pc_with_pending(PC_PASS w, m, 0u, turning, pc_six(Vec3(v.v1, v.v2, v.vn), Vec3(v.w1, v.w2, v.wn))));
  v.v1 = rate.l.x;
  v.v2 = rate.l.y;
  v.vn = rate.l.z;
  v.w1 = rate.a.x;
  v.w2 = rate.a.y;
  v.wn = rate.a.z;
  Visit r = pc_visit(PC_PASS m, v, now.shift, n, t1, t2, PC_INFO(contact_preload), acts, pc_bounce(PC_PASS w, m));
  pc_keep_room(PC_PASS w, m, r.room, acts);
  r.impulse = pc_select3(acts, r.impulse, pc_zero3());
  r.couple = pc_select3(acts, r.couple, pc_zero3());
  r.touch = pc_select(acts, r.touch, PC_REAL(0.0));

  Real changes = pc_max(r.touch, pc_max(pc_largest(r.impulse), pc_largest(r.couple)));
  Mask some = changes > PC_REAL(0.0);
  if (!PC_ANY(some)) return;  // lint: allow (nothing changes nothing)
  r.impulse = pc_select3(some, r.impulse, pc_zero3());
  r.couple = pc_select3(some, r.couple, pc_zero3());
  r.touch = pc_select(some, r.touch, PC_REAL(0.0));
  Mask tree_a = pc_in_tree(PC_PASS w, m, 0u);
  Mask tree_b = pc_in_tree(PC_PASS w, m, 1u);
  Real zero = PC_REAL(0.0);
  BodyState a = now.a;
  BodyState b = now.b;
  Vec3 torque_a = pc_select3(some, pc_moment(r.couple, now.arms.a, r.impulse), pc_zero3());
  Vec3 torque_b = pc_select3(some, pc_moment(r.couple, now.arms.b, r.impulse), pc_zero3());
  Real free_a = pc_free_mass(tree_a, a);
  Real free_b = pc_free_mass(tree_b, b);
  if (PC_ANY(pc_max(free_a, free_b) > zero)) {  // lint: allow (bodies of trees and those that stand keep their rows)
    a.phase = pc_select(free_a > zero, pc_max(a.phase, r.touch), a.phase);
    b.phase = pc_select(free_b > zero, pc_max(b.phase, r.touch), b.phase);
    pc_apply_free(PC_PASS ia, ib, a, b, tree_a, tree_b, r.impulse, torque_a, torque_b);
  }
  pc_push_trees(PC_PASS w, m, turning, t1, t2, n, r.impulse, r.couple, torque_a, torque_b, r.touch);
}
#undef PC_TREES
