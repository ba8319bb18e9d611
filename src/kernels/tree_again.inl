// After the contacts: the pins at the new prediction, with the same factor (Newton's second step, and what the contacts
// have undone), again where a gap is left; then the push that closes the gaps left over, which the relax phase takes back once the
// bodies have moved by it.
#include "body_state.inl"
#include "tree_rows.inl"
#include "tree_store.inl"
#include "angle_rows.inl"
#include "tree_sweep.inl"

// Limits keep what they carry; locked rows are corrected like pins.
PC_FN void pc_again_rates(PC_IO Slot n, Slot up, Real wanted) {
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return;  // lint: allow (zeros otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real bias = pc_soft_bias(PC_PASS PC_LD(tree_rows, n, TREE_SLACK + i));
    precise Real rate = (pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn) + bias) * wanted;
    PC_ST(tree_rows, n, TREE_RATE + i, pc_select(PC_LD(tree_rows, n, TREE_KIND + i) > PC_REAL(1.5), rate, PC_REAL(0.0)));
  }
}
// Speed at which a gap closes: within the sub-step, but not faster than joint_push_speed.
PC_FN Vec3 pc_closing(PC_IO Vec3 gap) {
  precise Vec3 v = gap * PC_INFO(inverse_h); Real size = pc_length(v); Real most = PC_INFO(joint_push_speed);
  Real share = pc_select(size > most, pc_div(most, pc_max(size, most)), PC_REAL(1.0)); return pc_scale(v, share);
}
// Remembers what acted on the joint: pin and angle impulses of the sub-step.
PC_FN void pc_remember_joint(PC_IO Tree t, Slot n, uint k) {
  Real flip = pc_select(PC_IS(pc_is_flipped(PC_PASS t, k)), PC_REAL(-1.0), PC_REAL(1.0)); Index joint = PC_ENDS(tree_ends, n, 1u);
  Real total = PC_LD(tree_rows, n, TREE_TOTAL); precise Vec3 pin = pc_ld3_tree(PC_PASS n, TREE_PIN) * flip * total;
  Vec3 s = pc_scale(pc_ld3_tree(PC_PASS n, TREE_LIMIT), total);
  precise Real r0 = s.x * PC_LD(tree_rows, n, TREE_SIGN); precise Real r1 = s.y * PC_LD(tree_rows, n, TREE_SIGN + 1u); precise Real r2 = s.z * PC_LD(tree_rows, n, TREE_SIGN + 2u);
  PC_SCATTER(joint_impulse, joint, 0u, pc_quad(pc_snap3(pin), PC_REAL(0.0)));
  PC_SCATTER(joint_impulse, joint, 1u, pc_quad(pc_snap3(Vec3(r0, r1, r2)), PC_REAL(0.0)));
}

// 1 where the prediction leaves a gap of more than 3e-5 of the arms: a step of Newton's method, which leaves
// about a tenth of it or less, is then not enough. Fast whips come to that.
PC_FN Real pc_gap_left(PC_IO Slot n) {
  Vec3 c = pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), PC_INFO(h)); Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC); Vec3 rp = pc_ld3_tree(PC_PASS n, TREE_RP);
  precise Real reach = (pc_dot(rc, rc) + pc_dot(rp, rp)) * PC_REAL(1e-9);
  return pc_select(pc_dot(c, c) > reach, PC_REAL(1.0), PC_REAL(0.0));
}
// One step of Newton's method on the pins at the prediction, where `wanted` is 1; nothing elsewhere.
PC_FN void pc_newton_step(PC_IO Slot m, Tree t, Real wanted) {
  for (uint k = 1u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k);
    pc_again_rates(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)), wanted);
    pc_st3_tree(PC_PASS n, TREE_C, pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), wanted));
  }
  pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PUSH, PC_REAL(1.0));
  for (uint k = 1u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st3_tree(PC_PASS n, TREE_PIN, pc_add(pc_ld3_tree(PC_PASS n, TREE_PIN), pc_ld3_tree(PC_PASS n, TREE_PUSH)));
    pc_st3_tree(PC_PASS n, TREE_LIMIT, pc_add(pc_ld3_tree(PC_PASS n, TREE_LIMIT), pc_row_impulses(PC_PASS t, n, k, PC_REAL(1.0))));
  }
  pc_tree_apply(PC_PASS m, t, pc_zero3(), pc_zero3());
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m); Real wanted = PC_REAL(1.0);
  for (uint k = 0u; k < t.count; k++) pc_st6_tree(PC_PASS PC_NODE(m, t.first + k), TREE_OUTSIDE, pc_six(pc_zero3(), pc_zero3()));
  for (uint turn = 0u; turn < 4u; turn++) {
    pc_tree_residual(PC_PASS m, t, wanted);
    Real left = PC_REAL(0.0);
    for (uint k = 1u; k < t.count; k++) left = pc_max(left, pc_gap_left(PC_PASS PC_NODE(m, t.first + k)));
    pc_newton_step(PC_PASS m, t, wanted);
    wanted = pc_min(wanted, left);
    if (!PC_ANY(wanted > PC_REAL(0.5))) break;  // lint: allow (steps of nothing change nothing)
  }
  for (uint k = 1u; k < t.count; k++) {
    Slot n = PC_NODE(m, t.first + k); pc_remember_joint(PC_PASS t, n, k); pc_st3_tree(PC_PASS n, TREE_RATE, pc_zero3());
    pc_st3_tree(PC_PASS n, TREE_C, pc_closing(PC_PASS pc_ld3_tree(PC_PASS n, TREE_GAP)));
  }
  if (pc_is_pivot(PC_PASS t) == 1u) {  // pivot_turn closes it: a sweep of nothing
    for (uint k = 0u; k < 2u; k++) {
      Slot n = PC_NODE(m, t.first + k); Vec3 none = pc_zero3(); Six still = pc_six(none, none);
      pc_st6_tree(PC_PASS n, TREE_F, still); pc_st6_tree(PC_PASS n, TREE_X, still); pc_st3_tree(PC_PASS n, TREE_C, none);
      pc_st3_tree(PC_PASS n, TREE_PUSH, none); pc_st3_tree(PC_PASS n, TREE_CHANGE, none); pc_st3_tree(PC_PASS n, TREE_PUSH_SPEED, none);
    }
    return;
  }
  pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PUSH, PC_REAL(0.0));
  pc_tree_apply(PC_PASS m, t, pc_zero3(), pc_zero3());
  for (uint k = 0u; k < t.count; k++) { Slot n = PC_NODE(m, t.first + k); pc_st3_tree(PC_PASS n, TREE_PUSH_SPEED, pc_ld3_tree(PC_PASS n, TREE_X)); }
}
