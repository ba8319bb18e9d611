// After the contacts: the pins at the new prediction, with the same factor (Newton's second step, and what the contacts
// have undone), again where a gap is left, a limit is crossed or one throws back; then the push that closes the gaps
// left over, which the relax phase takes back once the bodies have moved by it. All are rounds of one loop, so that
// compilers translate what they share once (with a second look ahead in it NVIDIA's makes other bits of it in double
// precision, where a work group shares a tree).
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

// How fast a limit that acts is crossed by the end of the sub-step, below 0; `rate`: that of its slack. What is beyond
// it already is not asked back here: velocities of that would meet the contacts of the relax phase.
PC_FN Real pc_crosses(PC_IO Slot n, uint i, Real rate) {
  Mask acts =
      pc_and(PC_LD(tree_rows, n, TREE_ON + i) > PC_REAL(0.5), PC_LD(tree_rows, n, TREE_KIND + i) < PC_REAL(2.0));
  precise Real over = rate + pc_max(PC_LD(tree_rows, n, TREE_SLACK + i), PC_REAL(0.0)) * PC_INFO(inverse_h);
  return pc_select(acts, pc_min(over, PC_REAL(0.0)), PC_REAL(0.0));
}
// Limits are not crossed and else keep what they carry, unless they throw back (where `rebounds`); locked rows are
// corrected like pins.
PC_FN void pc_again_rates(PC_IO Slot n, Slot up, Real wanted, Real most, bool rebounds) {
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return;  // lint: allow (zeros otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real now = pc_row_rate(PC_PASS n, up, i, turn, most);
    Real over = pc_crosses(PC_PASS n, i, now);
    if (rebounds) over = pc_min(over, pc_lacks_rebound(PC_PASS n, i, now));
    precise Real rate = pc_select(PC_LD(tree_rows, n, TREE_KIND + i) > PC_REAL(1.0), now, over) * wanted;
    PC_ST(tree_rows, n, TREE_RATE + i, rate);
  }
}
// Speed at which a gap closes: within the sub-step, but not faster than joint_push_speed.
PC_FN Vec3 pc_closing(PC_IO Vec3 gap) {
  precise Vec3 v = gap * PC_INFO(inverse_h);
  Real size = pc_length(v);
  Real most = PC_INFO(joint_push_speed);
  Real share = pc_share_within(size, most);
  return pc_scale(v, share);
}
// 1 where a limit is crossed by more than rounding, or one that throws back is left too slowly.
PC_FN Real pc_limit_lacks(PC_IO Slot n, Slot up) {
  Real lacks = PC_REAL(0.0);
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return lacks;  // lint: allow (zero otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real now = pc_row_rate(PC_PASS n, up, i, turn, PC_REAL(1.0));
    lacks = pc_select(pc_is_crossed(pc_crosses(PC_PASS n, i, now)), PC_REAL(1.0), lacks);
    lacks = pc_select(pc_lacks_much(PC_PASS n, i, pc_lacks_rebound(PC_PASS n, i, now)), PC_REAL(1.0), lacks);
  }
  return lacks;
}
// A gap is wide beyond 4e-5 of the arm: its square.
#define PC_WIDE_OPEN PC_REAL(2e-9)
// 1 where some gap of the tree at the prediction is more than rounding, and more than 4e-5 of the arm; in both, where a
// limit is crossed or has not thrown back yet.
struct Left {
  Real some;
  Real much;
};
// Run after pc_tree_residual.
PC_FN Left pc_left(PC_IO Slot m, Tree t) {
  precise Real share = pc_quarter(PC_INFO(rounding));
  precise Real noise = share * share;
  Left left;
  left.some = PC_REAL(0.0);
  left.much = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 gap = pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), PC_INFO(h));
    Real lacks = pc_limit_lacks(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
    left.some = pc_max(left.some, pc_max(pc_gap_over(PC_PASS n, gap, noise), lacks));
    left.much = pc_max(left.much, pc_max(pc_gap_over(PC_PASS n, gap, PC_WIDE_OPEN), lacks));
  }
  PC_MOST(left.some);
  PC_MOST(left.much);
  return left;
}
// 1 where a joint has angles that are locked, or its body turns about it: those are corrected whatever the pins.
PC_FN Real pc_always_again(PC_IO Slot m, Tree t) {
  if (pc_is_pivot(PC_PASS t) == 1u) return PC_REAL(1.0);
  Real kind = PC_REAL(0.0);
  PC_NODES(k, 1u, t)
  for (uint i = 0u; i < 3u; i++) kind = pc_max(kind, PC_LD(tree_rows, PC_NODE(m, t.first + k), TREE_KIND + i));
  PC_MOST(kind);
  return pc_select(kind > PC_REAL(1.0), PC_REAL(1.0), PC_REAL(0.0));
}
// What the push undoes of a joint's angles, as rates of its rows: as gaps, within the sub-step. 1 where there is any.
// Where contacts have begun it (`begun`), what that turns over limits as well.
PC_FN Real pc_push_angles(PC_IO Slot n, Slot up, Mask begun) {
  Real any = PC_REAL(0.0);
  pc_st3_tree(PC_PASS n, TREE_RATE, pc_zero3());
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return any;  // lint: allow (zeros otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real slack = PC_LD(tree_rows, n, TREE_SLACK + i);
    Mask acts = PC_LD(tree_rows, n, TREE_ON + i) > PC_REAL(0.5);
    Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
    Mask open = pc_and(slack > PC_REAL(0.0), kind < PC_REAL(2.0));
    precise Real beyond = slack - pc_little_beyond(PC_PASS slack, kind);
    Real undone = pc_select(pc_or(open, pc_abs(beyond) < PC_INFO(rounding)), PC_REAL(0.0), beyond);
    precise Real whole = undone * PC_INFO(inverse_h);
    Real rate = pc_select(acts, pc_within_push_speed(PC_PASS whole), PC_REAL(0.0));
    if (PC_ANY(begun)) {  // lint: allow (selected)
      Real now = pc_row_rate(PC_PASS n, up, i, turn, PC_REAL(1.0));
      Real turned = pc_select(kind > PC_REAL(1.0), now, pc_crosses(PC_PASS n, i, now));
      precise Real both = rate + turned;
      rate = pc_select(begun, both, rate);
    }
    PC_ST(tree_rows, n, TREE_RATE + i, rate);
    any = pc_select(pc_nonzero(rate), PC_REAL(1.0), any);
  }
  return any;
}
// What contacts have begun to push begins to move. 1 where there is any.
PC_FN Real pc_move_by_push(PC_IO Slot m, Tree t) {
  Real fastest = PC_REAL(0.0);
  if (pc_is_pivot(PC_PASS t) == 1u) return fastest;  // pivot_turn moves it
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 speed = pc_ld3_tree(PC_PASS n, TREE_PUSH_SPEED);
    Vec3 turn = pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN);
    fastest = pc_max(fastest, pc_max(pc_largest(speed), pc_largest(turn)));
    pc_st3_tree(PC_PASS n, TREE_X, speed);
    pc_st3_tree(PC_PASS n, TREE_CHANGE, turn);
  }
  PC_MOST(fastest);
  Mask begun = fastest > PC_REAL(0.0);
  if (PC_ANY(begun)) pc_tree_move(PC_PASS m, t, begun);  // lint: allow (nothing changes otherwise)
  return pc_select(begun, PC_REAL(1.0), PC_REAL(0.0));
}
// What the push goes on with: gaps of more than 32 epsilon of the arm are closed, also those that contacts have opened,
// and what is beyond its limits is turned back.
struct Push {
  Real open;
  Real turned;
  Real most;
};
PC_FN Push pc_begin_push(PC_IO Slot m, Tree t, Real noise, Real begun) {
  Push push;
  push.open = begun;
  push.turned = begun;
  push.most = PC_INFO(largest_state);
  Mask moves = begun > PC_REAL(0.5);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 gap = pc_ld3_tree(PC_PASS n, TREE_GAP);
    Real here = pc_gap_over(PC_PASS n, gap, noise);
    push.open = pc_max(push.open, here);
    Vec3 opened = pc_select3(moves, pc_ld3_tree(PC_PASS n, TREE_C), pc_zero3());
    pc_st3_tree(PC_PASS n, TREE_C, pc_madd(opened, pc_closing(PC_PASS gap), here));
    push.turned = pc_max(push.turned, pc_push_angles(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)), moves));
  }
  if (pc_is_pivot(PC_PASS t) == 1u) {  // pivot_turn closes it
    push.open = PC_REAL(0.0);
    push.turned = PC_REAL(0.0);
  }
  push.open = pc_max(push.open, push.turned);
  PC_MOST(push.open);
  PC_MOST(push.turned);
  return push;
}
// Rates that turn a joint's limits back which the push crosses. 1 where it does.
PC_FN Real pc_crossing_rates(PC_IO Slot n, Slot up, Real goes) {
  Real crossed = PC_REAL(0.0);
  pc_st3_tree(PC_PASS n, TREE_RATE, pc_zero3());
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return crossed;  // lint: allow (zeros otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real now = pc_row_rate(PC_PASS n, up, i, turn, PC_REAL(1.0));
    Real over = pc_crosses(PC_PASS n, i, now);
    crossed = pc_max(crossed, pc_select(pc_is_crossed(over), PC_REAL(1.0), PC_REAL(0.0)));
    precise Real rate = over * goes;
    PC_ST(tree_rows, n, TREE_RATE + i, rate);
  }
  return crossed;
}
// Where it turns, the arms' arcs open gaps again, and limits are crossed: those are closed with it, as long as less is
// left than at first (`most`, a speed squared). Run after pc_tree_residual.
// `much`: 1 where that is more than 4e-5 of an arm.
struct Rest {
  Real much;
  Real most;
};
PC_FN Rest pc_continue_push(PC_IO Slot m, Tree t, Real noise, Real turned, Real most) {
  Rest rest;
  rest.much = PC_REAL(0.0);
  rest.most = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 gap = pc_ld3_tree(PC_PASS n, TREE_GAP);
    Vec3 left = pc_madd(pc_ld3_tree(PC_PASS n, TREE_C), pc_closing(PC_PASS gap), pc_gap_over(PC_PASS n, gap, noise));
    rest.much = pc_max(rest.much, pc_gap_over(PC_PASS n, pc_scale(left, PC_INFO(h)), PC_WIDE_OPEN));
    rest.most = pc_max(rest.most, pc_dot(left, left));
    pc_st3_tree(PC_PASS n, TREE_C, left);
  }
  PC_MOST(rest.most);
  Real goes = pc_select(rest.most > most, PC_REAL(0.0), turned);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st3_tree(PC_PASS n, TREE_C, pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), goes));
    rest.much = pc_max(rest.much, pc_crossing_rates(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)), goes));
  }
  PC_MOST(rest.much);
  rest.much = pc_min(rest.much, goes);
  return rest;
}
// The same whether other lanes pushed.
PC_FN void pc_end_push(PC_IO Slot m, Tree t) {
  Vec3 zero = pc_zero3();
  Six none = pc_six(zero, zero);
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st6_tree(PC_PASS n, TREE_F, none);
    pc_st6_tree(PC_PASS n, TREE_X, none);
    pc_st3_tree(PC_PASS n, TREE_CHANGE, zero);
    if (k > 0u) {
      pc_st3_tree(PC_PASS n, TREE_C, zero);
      pc_st3_tree(PC_PASS n, TREE_RATE, zero);
      pc_st3_tree(PC_PASS n, TREE_PUSH, zero);
    }
  }
}

// Rates of the angle rows, and pins where `wanted` is 1; nothing elsewhere.
PC_FN void pc_newton_rates(PC_IO Slot m, Tree t, Real wanted, Real most, bool rebounds) {
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_again_rates(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)), wanted, most, rebounds);
    pc_st3_tree(PC_PASS n, TREE_C, pc_scale(pc_ld3_tree(PC_PASS n, TREE_C), wanted));
  }
}
// A sweep from TREE_C and TREE_RATE: what it changes goes to the bodies, its impulses to the joints, or its velocities
// to the push; or all of it to what limits throw back.
PC_FN void pc_solve_round(PC_IO Slot m, Tree t, bool throws, bool pushes) {
  pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PUSH, PC_REAL(1.0));
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    if (k > 0u && !throws && !pushes) {
      pc_st3_tree(PC_PASS n, TREE_PIN, pc_add(pc_ld3_tree(PC_PASS n, TREE_PIN), pc_ld3_tree(PC_PASS n, TREE_PUSH)));
      pc_st3_tree(PC_PASS n, TREE_LIMIT, pc_add(pc_ld3_tree(PC_PASS n, TREE_LIMIT), pc_row_impulses(PC_PASS t, n, k)));
    }
    pc_st3_tree(PC_PASS n, TREE_CHANGE,
                pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), pc_ld3_tree(PC_PASS n, TREE_X + 3u)));
  }
  pc_tree_conserve(PC_PASS m, t, pc_zero3(), pc_zero3());
  if (!throws) pc_tree_move(PC_PASS m, t, PC_IS(1u));
  if (throws || pushes) {
    PC_NODES(k, 0u, t) {
      Slot n = PC_NODE(m, t.first + k);
      if (throws) pc_add_to_throw(PC_PASS n);
      if (pushes) pc_add_to_push(PC_PASS n);
    }
  }
}
// After Newton's steps where `steps` is 1: 1 where they have not found their way, or where what they throw back is
// `late`; these are taken back.
PC_FN Real pc_judge_steps(PC_IO Slot m, Tree t, Real steps, Real thrown, Real late) {
  Real strayed = pc_min(pc_strayed(PC_PASS m, t), steps);
  // tension of a loop works as it closes
  if (pc_is_pivot(PC_PASS t) == 1u || pc_has_loop(PC_PASS t) == 1u) strayed = PC_REAL(0.0);
  // (of what is thrown back the energy before the solve tells, not what a stop has left of it)
  Real again = pc_select(thrown > PC_REAL(0.5), late, strayed);
  if (PC_ANY(again > PC_REAL(0.5))) {  // lint: allow (nothing changes otherwise)
    pc_take_back(PC_PASS m, t, again > PC_REAL(0.5));
  }
  return again;
}

// Rounds 0 to 3 are Newton's steps; then it is seen what limits throw back, two more steps follow where those were
// taken back, what is thrown late, and the push.
const uint ROUND_JUDGE = 4u;
const uint ROUND_AGAIN = 5u;
const uint ROUND_THROW = 7u;
const uint ROUND_PUSH = 11u;
const uint ROUND_END = 15u;

// Where a tree stands in its rounds: 1 where the round has something to do (`wanted`), where steps were taken, where
// limits throw back, and where they do so late; and the push.
struct Progress {
  Real wanted;
  Real steps;
  Real thrown;
  Real late;
  Push push;
};
PC_FN Progress pc_no_progress() {
  Progress p;
  p.wanted = PC_REAL(1.0);
  p.steps = PC_REAL(0.0);
  p.thrown = PC_REAL(0.0);
  p.late = PC_REAL(0.0);
  p.push.open = PC_REAL(0.0);
  p.push.turned = PC_REAL(0.0);
  p.push.most = PC_REAL(0.0);
  return p;
}
// What a round begins with, before it looks at the prediction.
PC_FN void pc_begin_round(PC_IO Slot m, Tree t, uint round, PC_INOUT(Progress) p) {
  if (round == ROUND_JUDGE) {
    p.thrown = pc_min(pc_tree_is_thrown(PC_PASS m, t), p.steps);
    p.wanted = p.thrown;
  }
  if (round == ROUND_AGAIN) {
    p.wanted = PC_REAL(0.0);
    if (PC_ANY(p.steps > PC_REAL(0.5))) {  // lint: allow (nothing changes otherwise)
      p.wanted = pc_judge_steps(PC_PASS m, t, p.steps, p.thrown, p.late);
    }
  }
  if (round == ROUND_THROW) p.wanted = p.late;
  if (round == ROUND_PUSH) {
    Mask late = p.late > PC_REAL(0.5);
    Mask thrown = p.thrown > PC_REAL(0.5);
    if (PC_ANY(late)) pc_end_throw(PC_PASS m, t, late);            // lint: allow (as above)
    if (PC_ANY(thrown)) pc_tell_blow(PC_PASS m, t, thrown, late);  // lint: allow (as above)
    PC_NODES(k, 1u, t) pc_remember_joint(PC_PASS t, PC_NODE(m, t.first + k), k);
    p.wanted = pc_move_by_push(PC_PASS m, t);
  }
  if (round > ROUND_PUSH) p.wanted = pc_min(p.wanted, p.push.turned);
}

// What is rounding (8 epsilon of the arm) is left: in a pile at rest that is nearly all. Steps of Newton's method go on
// where more than 4e-5 of the arm was left, since one leaves about a tenth of it or less: fast whips come to that.
PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  precise Real noise = PC_INFO(rounding) * PC_INFO(rounding);
  PC_NODES(k, 0u, t) pc_st6_tree(PC_PASS PC_NODE(m, t.first + k), TREE_OUTSIDE, pc_six(pc_zero3(), pc_zero3()));
  Progress p = pc_no_progress();
  for (uint round = 0u; round < ROUND_END; round++) {
    pc_begin_round(PC_PASS m, t, round, p);
    bool throws = round >= ROUND_THROW && round < ROUND_PUSH;
    Real most = PC_REAL(1.0);
    bool goes_on = PC_ANY(p.wanted > PC_REAL(0.5)) && !(throws && round > ROUND_THROW);
    if (goes_on) {  // lint: allow (rounds of nothing change nothing)
      if (round == ROUND_AGAIN || round == ROUND_AGAIN + 1u) most = PC_INFO(stale_share);
      pc_tree_residual_to(PC_PASS m, t, p.wanted, most);
    }
    if (round == ROUND_PUSH) {
      p.push = pc_begin_push(PC_PASS m, t, noise, p.wanted);
      p.wanted = p.push.open;
    }
    if (!PC_ANY(p.wanted > PC_REAL(0.5))) continue;  // lint: allow (rounds of nothing change nothing)
    if (round == ROUND_JUDGE) {
      p.late = pc_min(pc_throws_too_far(PC_PASS m, t), p.thrown);
      continue;
    }
    Left left;
    left.some = PC_REAL(1.0);
    left.much = PC_REAL(1.0);
    if (round < ROUND_JUDGE) left = pc_left(PC_PASS m, t);
    if (round == 0u) {
      p.wanted = pc_max(pc_always_again(PC_PASS m, t), left.some);
      p.steps = p.wanted;
      if (!PC_ANY(p.steps > PC_REAL(0.5))) continue;  // lint: allow (as above)
      pc_keep_motion(PC_PASS m, t, p.steps > PC_REAL(0.5));
    }
    if (round < ROUND_THROW) pc_newton_rates(PC_PASS m, t, p.wanted, most, round < ROUND_JUDGE);
    if (throws) left.much = pc_throw_rates(PC_PASS m, t, round == ROUND_THROW);
    if (round > ROUND_PUSH) {
      Rest rest = pc_continue_push(PC_PASS m, t, noise, p.wanted, p.push.most);
      left.much = rest.much;
      if (round == ROUND_PUSH + 1u) p.push.most = rest.most;
    }
    pc_solve_round(PC_PASS m, t, throws, round >= ROUND_PUSH);
    p.wanted = pc_min(p.wanted, left.much);
  }
  Mask late = p.late > PC_REAL(0.5);
  if (PC_ANY(late)) pc_push_against_throw(PC_PASS m, t, late);  // lint: allow (nothing changes otherwise)
  pc_end_push(PC_PASS m, t);
}
