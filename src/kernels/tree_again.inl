// After the contacts: the pins at the new prediction, with the same factor (Newton's second step, and what the contacts
// have undone), again where a gap is left, a limit is crossed or one throws back; then the push that closes the gaps left over, which the relax
// phase takes back once the bodies have moved by it.
#include "body_state.inl"
#include "tree_rows.inl"
#include "tree_store.inl"
#include "angle_rows.inl"
#include "tree_sweep.inl"
#include "tree_momentum.inl"
#include "tree_predict.inl"
#include "tree_joint_kept.inl"
#include "tree_gap.inl"
#include "tree_trust.inl"
#include "tree_rebound.inl"

// Of a limit that is met and throws back, how far its rate lacks of that at which it is to be left; else 0.
PC_FN Real pc_lacks_rebound(PC_IO Slot n, uint i, Real rate) {
  Real away = PC_LD(tree_rows, n, TREE_REBOUND + i); Mask rebounds = pc_and(pc_throws_back(PC_PASS n), pc_and(PC_LD(tree_rows, n, TREE_ON + i) > PC_REAL(0.5), away > PC_REAL(0.0)));
  precise Real lack = rate - away; return pc_select(rebounds, pc_min(lack, PC_REAL(0.0)), PC_REAL(0.0));
}
// How fast a limit that acts is crossed by the end of the sub-step, below 0; `rate`: that of its slack. What is beyond it already is not asked back
// here: velocities of that would meet the contacts of the relax phase.
PC_FN Real pc_crosses(PC_IO Slot n, uint i, Real rate) {
  Mask acts = pc_and(PC_LD(tree_rows, n, TREE_ON + i) > PC_REAL(0.5), PC_LD(tree_rows, n, TREE_KIND + i) < PC_REAL(1.5));
  precise Real over = rate + pc_max(PC_LD(tree_rows, n, TREE_SLACK + i), PC_REAL(0.0)) * PC_INFO(inverse_h);
  return pc_select(acts, pc_min(over, PC_REAL(0.0)), PC_REAL(0.0));
}
// Limits are not crossed and else keep what they carry, unless they throw back; locked rows are corrected like pins.
PC_FN void pc_again_rates(PC_IO Slot n, Slot up, Real wanted) {
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return;  // lint: allow (zeros otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real now = pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
    Real over = pc_crosses(PC_PASS n, i, now);
    if (PC_ANY(pc_throws_back(PC_PASS n))) over = pc_min(over, pc_lacks_rebound(PC_PASS n, i, now));  // lint: allow (zero otherwise)
    precise Real rate = pc_select(PC_LD(tree_rows, n, TREE_KIND + i) > PC_REAL(1.5), now, over) * wanted;
    PC_ST(tree_rows, n, TREE_RATE + i, rate);
  }
}
// Speed at which a gap closes: within the sub-step, but not faster than joint_push_speed.
PC_FN Vec3 pc_closing(PC_IO Vec3 gap) {
  precise Vec3 v = gap * PC_INFO(inverse_h); Real size = pc_length(v); Real most = PC_INFO(joint_push_speed);
  Real share = pc_share_within(size, most); return pc_scale(v, share);
}
// 1 where a limit is crossed by more than rounding, or one that throws back is left too slowly, by more than 1e-5 of its rate.
PC_FN Real pc_limit_lacks(PC_IO Slot n, Slot up) {
  Real lacks = PC_REAL(0.0);
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return lacks;  // lint: allow (zero otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real now = pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
    lacks = pc_select(pc_is_crossed(pc_crosses(PC_PASS n, i, now)), PC_REAL(1.0), lacks);
    if (PC_ANY(pc_throws_back(PC_PASS n))) {  // lint: allow (none otherwise)
      precise Real much = PC_LD(tree_rows, n, TREE_REBOUND + i) * PC_REAL(-1e-5);
      lacks = pc_select(pc_lacks_rebound(PC_PASS n, i, now) < much, PC_REAL(1.0), lacks);
    }
  }
  return lacks;
}
// 1 where some gap of the tree at the prediction is, or a limit has not thrown back yet. Run after pc_tree_residual.
PC_FN Real pc_left(PC_IO Slot m, Tree t, Real share_squared) {
  Real left = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    left = pc_max(left, pc_gap_over(PC_PASS n, pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), PC_INFO(h)), share_squared));
    left = pc_max(left, pc_limit_lacks(PC_PASS n, up));
  }
  PC_MOST(left);
  return left;
}
// 1 where a joint has angles that are locked, or its body turns about it: those are corrected whatever the pins.
PC_FN Real pc_always_again(PC_IO Slot m, Tree t) {
  if (pc_is_pivot(PC_PASS t) == 1u) return PC_REAL(1.0);
  Real kind = PC_REAL(0.0);
  PC_NODES(k, 1u, t)
    for (uint i = 0u; i < 3u; i++) kind = pc_max(kind, PC_LD(tree_rows, PC_NODE(m, t.first + k), TREE_KIND + i));
  PC_MOST(kind); return pc_select(kind > PC_REAL(1.5), PC_REAL(1.0), PC_REAL(0.0));
}
// One step of Newton's method on the pins at the prediction, where `wanted` is 1; nothing elsewhere.
PC_FN void pc_newton_step(PC_IO Slot m, Tree t, Real wanted) {
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_again_rates(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)), wanted);
    pc_st3_tree(PC_PASS n, TREE_C, pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), wanted));
  }
  pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PUSH, PC_REAL(1.0));
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st3_tree(PC_PASS n, TREE_PIN, pc_add(pc_ld3_tree(PC_PASS n, TREE_PIN), pc_ld3_tree(PC_PASS n, TREE_PUSH)));
    pc_st3_tree(PC_PASS n, TREE_LIMIT, pc_add(pc_ld3_tree(PC_PASS n, TREE_LIMIT), pc_row_impulses(PC_PASS t, n, k)));
  }
  pc_tree_apply(PC_PASS m, t, pc_zero3(), pc_zero3());
}

// What the push undoes of a joint's angles, as rates of its rows. 1 where there is any.
PC_FN Real pc_push_angles(PC_IO Slot n) {
  Real any = PC_REAL(0.0);
  pc_st3_tree(PC_PASS n, TREE_RATE, pc_zero3());
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return any;  // lint: allow (zeros otherwise)
  for (uint i = 0u; i < 3u; i++) {
    Real slack = PC_LD(tree_rows, n, TREE_SLACK + i);
    Mask acts = PC_LD(tree_rows, n, TREE_ON + i) > PC_REAL(0.5);
    Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
    Mask open = pc_and(slack > PC_REAL(0.0), kind < PC_REAL(1.5));
    precise Real beyond = slack - pc_little_beyond(PC_PASS slack, kind);
    Real undone = pc_select(pc_or(open, pc_abs(beyond) < PC_INFO(rounding)), PC_REAL(0.0), beyond);
    Real rate = pc_select(acts, pc_soft_bias(PC_PASS undone), PC_REAL(0.0));
    PC_ST(tree_rows, n, TREE_RATE + i, rate);
    any = pc_select(pc_nonzero(rate), PC_REAL(1.0), any);
  }
  return any;
}
// What a sweep from TREE_C and TREE_RATE gives, to the bodies and to the push.
PC_FN void pc_push(PC_IO Slot m, Tree t) {
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st3_tree(PC_PASS n, TREE_PUSH_TURN, pc_ld3_tree(PC_PASS n, TREE_CHANGE));
  }
  pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PUSH, PC_REAL(1.0));
  pc_tree_apply(PC_PASS m, t, pc_zero3(), pc_zero3());
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st3_tree(PC_PASS n, TREE_PUSH_SPEED, pc_add(pc_ld3_tree(PC_PASS n, TREE_PUSH_SPEED), pc_ld3_tree(PC_PASS n, TREE_X)));
    pc_st3_tree(PC_PASS n, TREE_CHANGE, pc_add(pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN), pc_ld3_tree(PC_PASS n, TREE_CHANGE)));
  }
}
// The push that closes gaps of more than 32 epsilon of the arm and turns back what is beyond its limits. Where it turns, the arms' arcs open
// gaps again: those are closed with it.
PC_FN void pc_push_gaps(PC_IO Slot m, Tree t) {
  precise Real noise = PC_INFO(rounding) * PC_INFO(rounding); Real open = PC_REAL(0.0); Real turned = PC_REAL(0.0); Vec3 zero = pc_zero3();
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st3_tree(PC_PASS n, TREE_PUSH_SPEED, zero); pc_st3_tree(PC_PASS n, TREE_CHANGE, zero);
  }
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k); Vec3 gap = pc_ld3_tree(PC_PASS n, TREE_GAP); Real here = pc_gap_over(PC_PASS n, gap, noise); open = pc_max(open, here);
    pc_st3_tree(PC_PASS n, TREE_C, pc_scale(pc_closing(PC_PASS gap), here)); turned = pc_max(turned, pc_push_angles(PC_PASS n));
  }
  if (pc_is_pivot(PC_PASS t) == 1u) { open = PC_REAL(0.0); turned = PC_REAL(0.0); }  // pivot_turn closes it
  open = pc_max(open, turned); PC_MOST(open); PC_MOST(turned);
  if (PC_ANY(open > PC_REAL(0.5))) pc_push(PC_PASS m, t);  // lint: allow (a push of nothing changes nothing)
  if (PC_ANY(turned > PC_REAL(0.5))) {  // lint: allow (selected below)
    pc_tree_residual(PC_PASS m, t, turned);
    PC_NODES(k, 1u, t) {
      Slot n = PC_NODE(m, t.first + k); Vec3 gap = pc_ld3_tree(PC_PASS n, TREE_GAP); Real here = pc_gap_over(PC_PASS n, gap, noise);
      Vec3 left = pc_madd(pc_ld3_tree(PC_PASS n, TREE_C), pc_closing(PC_PASS gap), here);
      pc_st3_tree(PC_PASS n, TREE_C, pc_scale(left, turned)); pc_st3_tree(PC_PASS n, TREE_RATE, zero);
    }
    pc_push(PC_PASS m, t);
  }
  PC_NODES(k, 0u, t) {  // the same whether other lanes pushed
    Slot n = PC_NODE(m, t.first + k); Six none = pc_six(zero, zero);
    pc_st6_tree(PC_PASS n, TREE_F, none); pc_st6_tree(PC_PASS n, TREE_X, none); pc_st3_tree(PC_PASS n, TREE_PUSH_TURN, zero);
    if (k > 0u) { pc_st3_tree(PC_PASS n, TREE_C, zero); pc_st3_tree(PC_PASS n, TREE_RATE, zero); pc_st3_tree(PC_PASS n, TREE_PUSH, zero); }
  }
}

// What is rounding (8 epsilon of the arm) is left: in a pile at rest that is nearly all. Steps of Newton's method go on where more than
// 4e-5 of the arm was left, since one leaves about a tenth of it or less: fast whips come to that.
PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m); precise Real share = PC_INFO(rounding) * PC_REAL(0.25); precise Real noise = share * share;
  PC_NODES(k, 0u, t) pc_st6_tree(PC_PASS PC_NODE(m, t.first + k), TREE_OUTSIDE, pc_six(pc_zero3(), pc_zero3()));
  pc_tree_residual(PC_PASS m, t, PC_REAL(1.0)); Real wanted = pc_max(pc_always_again(PC_PASS m, t), pc_left(PC_PASS m, t, noise));
  Real steps = wanted;
  if (PC_ANY(steps > PC_REAL(0.5))) pc_keep_motion(PC_PASS m, t, steps > PC_REAL(0.5));  // lint: allow (nothing changes otherwise)
  for (uint turn = 0u; turn < 4u; turn++) {
    if (!PC_ANY(wanted > PC_REAL(0.5))) break;  // lint: allow (steps of nothing change nothing)
    if (turn > 0u) pc_tree_residual(PC_PASS m, t, wanted);
    Real left = pc_left(PC_PASS m, t, PC_REAL(2e-9));
    pc_newton_step(PC_PASS m, t, wanted);
    wanted = pc_min(wanted, left);
  }
  if (PC_ANY(steps > PC_REAL(0.5))) {  // lint: allow (as above)
    Real strayed = pc_min(pc_strayed(PC_PASS m, t), steps);
    if (pc_is_pivot(PC_PASS t) == 1u || pc_has_loop(PC_PASS t) == 1u) strayed = PC_REAL(0.0);  // tension of a loop works as it closes
    // (of what is thrown back the energy before the solve tells, not what a stop has left of it)
    Real thrown = pc_tree_is_thrown(PC_PASS m, t);
    strayed = pc_select(thrown > PC_REAL(0.5), PC_REAL(0.0), strayed);
    Real kept = pc_select(strayed > PC_REAL(0.5), PC_REAL(0.0), PC_REAL(1.0));
    if (PC_ANY(thrown > PC_REAL(0.5))) kept = pc_select(thrown > PC_REAL(0.5), pc_rebound_share(PC_PASS m, t), kept);  // lint: allow (as above)
    Real again = pc_select(kept < PC_REAL(1.0), steps, PC_REAL(0.0));
    if (PC_ANY(again > PC_REAL(0.5))) {  // lint: allow (as above)
      pc_take_back(PC_PASS m, t, kept, again > PC_REAL(0.5));
      for (uint turn = 0u; turn < 2u; turn++) {
        pc_tree_residual_to(PC_PASS m, t, again, PC_INFO(strayed_turn));
        pc_newton_step(PC_PASS m, t, again);
      }
    }
    if (PC_ANY(thrown > PC_REAL(0.5))) pc_tell_blow(PC_PASS m, t, pc_and(steps > PC_REAL(0.5), thrown > PC_REAL(0.5)));  // lint: allow (as above)
  }
  PC_NODES(k, 1u, t) pc_remember_joint(PC_PASS t, PC_NODE(m, t.first + k), k);
  pc_push_gaps(PC_PASS m, t);
}
