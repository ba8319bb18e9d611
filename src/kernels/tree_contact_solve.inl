// Visits a manifold with a body of a tree, inside the space that the joints leave: what is pending in the tree comes down to
// the body, the rows are solved as those of free bodies are (contact_visit.inl), and the impulse goes up to the root. The
// velocities of trees follow with tree_flush.
#define PC_MEAN
#include "tree_math.inl"
#include "contact_way.inl"
#include "node_operator.inl"
#include "node_motion.inl"
#include "contact_rows.inl"
#include "contact_response.inl"
#include "contact_visit.inl"

// What the pending motion of both sides adds to the twist.
PC_FN Twist pc_twist_with(Twist v, Six xa, Six xb, Arms arms, Vec3 n, Vec3 t1, Vec3 t2) {
  Vec3 l = pc_sub(pc_add(xb.l, pc_cross(xb.a, arms.b)), pc_add(xa.l, pc_cross(xa.a, arms.a))); Vec3 a = pc_sub(xb.a, xa.a);
  precise Real v1 = v.v1 + pc_dot(t1, l); precise Real v2 = v.v2 + pc_dot(t2, l); precise Real vn = v.vn + pc_dot(n, l);
  precise Real w1 = v.w1 + pc_dot(t1, a); precise Real w2 = v.w2 + pc_dot(t2, a); precise Real wn = v.wn + pc_dot(n, a);
  Twist r; r.v1 = v1; r.v2 = v2; r.vn = vn; r.w1 = w1; r.w2 = w2; r.wn = wn; return r;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY)); Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N); Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T); Vec3 t2 = pc_cross(n, t1);
  Quad moved_a = PC_GATHER(delta, ia, 0u); Quad moved_b = PC_GATHER(delta, ib, 0u);
  Shift shift = pc_shift_of(PC_PASS m, n, t1, t2, moved_a, moved_b, PC_GATHER(delta, ia, 1u), PC_GATHER(delta, ib, 1u));
  Arms arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  Six xa = pc_pending(PC_PASS w, m, 0u); Six xb = pc_pending(PC_PASS w, m, 1u);
  BodyState a = pc_body_state(PC_PASS ia); BodyState b = pc_body_state(PC_PASS ib);
  Visit r = pc_visit(PC_PASS m, pc_twist_with(pc_twist(a, b, arms, n, t1, t2), xa, xb, arms, n, t1, t2), shift, n, t1, t2);

  Mask tree_a = pc_in_tree(PC_PASS w, m, 0u); Mask tree_b = pc_in_tree(PC_PASS w, m, 1u); Real zero = PC_REAL(0.0);
  a.phase = pc_select(a.inverse_mass > zero, pc_max(a.phase, r.touch), a.phase); b.phase = pc_select(b.inverse_mass > zero, pc_max(b.phase, r.touch), b.phase);
  Vec3 torque_a = pc_add(r.couple, pc_cross(arms.a, r.impulse)); Vec3 torque_b = pc_add(r.couple, pc_cross(arms.b, r.impulse));
  pc_apply_free(PC_PASS ia, ib, a, b, tree_a, tree_b, r.impulse, torque_a, torque_b);
  pc_push_tree(PC_PASS w, m, 0u, tree_a, pc_six(pc_negate(r.impulse), pc_negate(torque_a)));
  pc_push_tree(PC_PASS w, m, 1u, tree_b, pc_six(r.impulse, torque_b));
}
#undef PC_MEAN
#undef pc_mean
#undef pc_soft_rate
#undef pc_soft_mass_scale
#undef pc_soft_impulse_scale
