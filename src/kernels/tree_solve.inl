// The direct solve of a joint tree: its factor, and the impulses that keep every gap over the sub-step. Which angle
// rows act is found by an active set: those violated at the predicted pose enter, those that would pull leave, and the
// tree is factored anew, a few times at most.
#include "body_state.inl"
#include "tree_rows.inl"
#include "tree_store.inl"
#include "angle_rows.inl"
#ifdef PC_DRIVES
#include "tree_drive.inl"
#endif
#include "tree_factor.inl"
#include "tree_sweep.inl"
#include "tree_energy.inl"
#include "tree_momentum.inl"
#include "tree_predict.inl"

// The limit of a row is the one that is nearer halfway through the sub-step: a joint that turns fast goes from one to
// beyond the other within one. (A cone is left on its other side; its limit stays the same.)
PC_FN void pc_choose_limit(PC_IO Slot n, uint i, Vec3 turn) {
  Vec3 axis = pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u);
  Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
  Real slack = PC_LD(tree_rows, n, TREE_SLACK + i);
  Real sign = PC_LD(tree_rows, n, TREE_SIGN + i);
  Real on = PC_LD(tree_rows, n, TREE_ON + i);
  Real span = PC_LD(tree_rows, n, TREE_SPAN + i);
  precise Real doubled = slack * PC_REAL(2.0) + pc_dot(axis, turn) * PC_INFO(h);
  Mask is_limit =
      pc_and(pc_and(kind > PC_REAL(0.5), kind < PC_REAL(2.0)), PC_LD(tree_rows, n, TREE_PIVOT) < PC_REAL(0.5));
  Mask other = pc_and(is_limit, doubled > span);
  if (!PC_ANY(other)) return;  // lint: allow (rows stay otherwise)
  precise Real left = span - slack;
  Vec3 inner = pc_ld3_tree(PC_PASS n, TREE_CONE);
  Mask is_cone = pc_nonzero(pc_dot(inner, inner));
  Real other_sign = -sign;
  if (i == 1u) other_sign = pc_select(is_cone, sign, -sign);
  pc_st3_tree(PC_PASS n, TREE_AXIS + i * 3u, pc_select3(other, pc_negate(axis), axis));
  PC_ST(tree_rows, n, TREE_SLACK + i, pc_select(other, left, slack));
  PC_ST(tree_rows, n, TREE_SIGN + i, pc_select(other, other_sign, sign));
  PC_ST(tree_rows, n, TREE_ON + i, pc_select(other, PC_REAL(0.0), on));
  if (!PC_ANY(pc_throws_back(PC_PASS n))) return;  // lint: allow (not read otherwise)
  Real back = PC_LD(tree_rows, n, TREE_REBOUND + i);
  PC_ST(tree_rows, n, TREE_REBOUND + i, pc_select(other, pc_abs(back), back));
}
// Of an angle row its limit, the axis of halfway, and the rate at which the limit is come to; of its slack the rate
// over the sub-step.
PC_FN Real pc_begin_row(PC_IO Slot n, Slot up, uint i, Vec3 turn) {
  pc_choose_limit(PC_PASS n, i, turn);
  Real now = pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
  PC_ST(tree_rows, n, TREE_APPROACH + i, pc_min(now, PC_REAL(0.0)));
  Ahead ahead = pc_row_ahead(PC_PASS n, up, i, turn, PC_REAL(1.0));
  pc_st3_tree(PC_PASS n, TREE_AXIS + i * 3u, ahead.axis);
  return ahead.rate;
}
// Rates of the angle rows' slacks that the solve must undo. Run after pc_tree_residual, whose TREE_X holds velocities.
PC_FN void pc_tree_rates(PC_IO Slot n, Slot up) {
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return;  // lint: allow (zeros otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real ahead = pc_begin_row(PC_PASS n, up, i, turn);
    Real slack = PC_LD(tree_rows, n, TREE_SLACK + i);
    Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
    Mask open = pc_and(slack > PC_REAL(0.0), kind < PC_REAL(2.0));
    Real wanted = pc_angle_bias(PC_PASS pc_select(open, slack, pc_little_beyond(PC_PASS slack, kind)), open);
    precise Real rate = ahead + wanted;
    PC_ST(tree_rows, n, TREE_RATE + i, rate);
    Real on = PC_LD(tree_rows, n, TREE_ON + i);
    PC_ST(tree_rows, n, TREE_ON + i, pc_select(pc_and(kind > PC_REAL(0.5), rate < PC_REAL(0.0)), PC_REAL(1.0), on));
  }
}
// The rate at which a row is left that the joint comes to, where its limits throw back: Newton's law in the row's rate.
PC_FN void pc_tree_rebounds(PC_IO Slot n, Slot up) {
  if (!PC_ANY(pc_throws_back(PC_PASS n))) return;  // lint: allow (not read otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    precise Real approach = -pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
    precise Real away = approach * PC_LD(tree_rows, n, TREE_REBOUND + i);
    Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
    Mask meets = pc_and(approach > PC_INFO(restitution_threshold), kind < PC_REAL(2.0));
    Real rate = pc_select(meets, pc_max(away, PC_REAL(0.0)), PC_REAL(0.0));
    // (of no row it is pivot_turn's)
    PC_ST(tree_rows, n, TREE_REBOUND + i, pc_select(kind < PC_REAL(0.5), PC_LD(tree_rows, n, TREE_REBOUND + i), rate));
  }
}
// After a sweep: rows that pull leave, and those enter that it violates. 1 where any did.
PC_FN Real pc_tree_revise(PC_IO Slot n, Slot up) {
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return PC_REAL(0.0);  // lint: allow (zeros otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  Real changed = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  for (uint i = 0u; i < 3u; i++) {
    Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
    Real on = PC_LD(tree_rows, n, TREE_ON + i);
    Real impulse = pc_row_impulse(PC_PASS n, i, turn);
    Mask is_limit = pc_and(kind > PC_REAL(0.5), kind < PC_REAL(2.0));
    Mask leaves = pc_and(is_limit, pc_and(on > PC_REAL(0.5), impulse < PC_REAL(0.0)));
    Mask enters = pc_enters(PC_PASS n, i, turn);
    PC_ST(tree_rows, n, TREE_ON + i, pc_select(leaves, PC_REAL(0.0), pc_select(enters, one, on)));
    changed = pc_select(pc_or(leaves, enters), one, changed);
  }
  return changed;
}
// After the solve: the rates that are left.
PC_FN void pc_rates_left(PC_IO Slot n, Slot up) {
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return;  // lint: allow (zeros otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) PC_ST(tree_rows, n, TREE_RATE + i, pc_rate_after(PC_PASS n, i, turn));
}

#define PC_EARLY_DAMPING PC_REAL(0.02)
// Share of what a sub-step cannot resolve that is damped, 0 to 1; `fast` = x / (1 + x) of a body's pins. Alone a tree
// needs it near the limit of stability, x = 1: 4 fast^2 is a damping of fourth order in x, and what the sub-step
// resolves keeps its energy. Loops and contacts act on a tree from outside of its solve and feed its modes: there it
// begins at x = 0.02, and where an arm swings by more than a seventh of a radian in the sub-step.
PC_FN Real pc_damped_share(PC_IO Real fast, Real swing, Mask held) {
  Real zero = PC_REAL(0.0);
  precise Real beyond = fast - PC_EARLY_DAMPING;
  precise Real swung = swing - PC_EARLY_DAMPING;
  precise Real whip = swung * pc_div(PC_REAL(1.0), PC_INFO(stale_share));
  precise Real early = pc_max(beyond, zero) * pc_inverse_or_zero(fast) + pc_clamp(whip, zero, PC_REAL(1.0));
  precise Real square = fast * fast;
  Real late = pc_four_times(square);
  Real alone = pc_select(fast > PC_LITTLE, late, zero);  // less is rounding, and its squares would be subnormal
  return pc_min(pc_select(held, early, alone), PC_REAL(1.0));
}
// 1 where a limit of the joint acts.
PC_FN Real pc_at_limit(PC_IO Slot n) {
  Real most = PC_REAL(0.0);
  for (uint i = 0u; i < 3u; i++) {
    precise Real off = PC_LD(tree_rows, n, TREE_KIND + i) - PC_REAL(1.0);
    most = pc_max(most, pc_select(pc_abs(off) < PC_REAL(0.5), PC_LD(tree_rows, n, TREE_ON + i), PC_REAL(0.0)));
  }
  return most;
}
// An impulse against the turning of bodies with stiff pins. `held`: something acts on the tree from outside, or a limit
// does. Run after pc_tree_residual.
PC_FN void pc_tree_damping(PC_IO Slot m, Tree t, Mask held) {
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    // (how far the arm swings against the parent, as an angle squared: a top may spin about it as it likes)
    Vec3 arm = pc_ld3_tree(PC_PASS n, TREE_RC);
    Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
    Vec3 way = pc_scale(pc_cross(turn, arm), PC_INFO(h));
    precise Real swing = pc_dot(way, way) * pc_inverse_or_zero(pc_dot(arm, arm));
    Real share = pc_damped_share(PC_PASS PC_LD(tree_rows, n, TREE_FAST), swing, held);
    precise Real scale = share * PC_INFO(tree_damping) * PC_REAL(-2.0);
    Sym3 stiffness = pc_sym_sub(pc_lds_tree(PC_PASS n, TREE_INERTIA), pc_lds_tree(PC_PASS n, TREE_BODY));
    pc_st3_tree(PC_PASS n, TREE_OUTSIDE + 3u,
                pc_madd(pc_ld3_tree(PC_PASS n, TREE_OUTSIDE + 3u),
                        pc_sym_mul(stiffness, pc_ld3_tree(PC_PASS n, TREE_X + 3u)), scale));
  }
}

// What contacts and loops give to the tree as a whole, as an impulse and a moment about its root's centre; and `load`,
// above 0 where they do, or where a limit acts.
struct Outside {
  Vec3 push;
  Vec3 turn;
  Real load;
};
PC_FN Outside pc_outside(PC_IO Slot m, Tree t) {
  Outside all;
  all.push = pc_zero3();
  all.turn = pc_zero3();
  all.load = PC_REAL(0.0);
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Six f = pc_ld6_tree(PC_PASS n, TREE_OUTSIDE);
    all.push = pc_add(all.push, f.l);
    all.load = pc_max(all.load, pc_max(pc_largest(f.l), pc_largest(f.a)));
    precise Vec3 moment = all.turn + f.a + pc_cross(pc_ld3_tree(PC_PASS n, TREE_PLACE), f.l);
    all.turn = moment;
  }
  PC_NODES(k, 1u, t) all.load = pc_max(all.load, pc_at_limit(PC_PASS PC_NODE(m, t.first + k)));
  PC_MOST(all.load);
  return all;
}
// The rates that angle rows and drives must undo, and the tree's energy where a limit throws back.
PC_FN void pc_begin_rates(PC_IO Slot m, Tree t) {
  Real throws = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    pc_tree_rates(PC_PASS n, up);
    pc_tree_rebounds(PC_PASS n, up);
    throws = pc_select(pc_throws_back(PC_PASS n), PC_REAL(1.0), throws);
  }
  PC_MOST(throws);
  if (PC_ANY(throws > PC_REAL(0.5))) {  // lint: allow (not read otherwise)
    Real energy = pc_tree_energy(PC_PASS m, t);
    PC_ONE PC_ST(tree_rows, PC_NODE(m, t.first), TREE_ENERGY, energy);
  }
#ifdef PC_DRIVES
  PC_NODES(k, 1u, t) pc_drive_rates(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
#endif
}
// After a sweep: joints of which something else is to act are stale. 1 where there is one.
PC_FN Real pc_revise(PC_IO Slot m, Tree t, bool first) {
  Real changed = PC_REAL(0.0);
  PC_ONE PC_ST(tree_rows, PC_NODE(m, t.first), TREE_STALE, changed);
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    Real here = pc_tree_revise(PC_PASS n, up);
#ifdef PC_DRIVES
    here = pc_max(here, pc_drive_revise(PC_PASS n, up, first));
#endif
    PC_ST(tree_rows, n, TREE_STALE, here);
    changed = pc_max(changed, here);
  }
  PC_MOST(changed);
  return changed;
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  Real one = PC_REAL(1.0);
  pc_tree_residual(PC_PASS m, t, one);
  Outside outside = pc_outside(PC_PASS m, t);
  pc_begin_rates(PC_PASS m, t);
  pc_tree_damping(PC_PASS m, t, outside.load > PC_REAL(0.0));
  for (uint round = 0u; round < 4u; round++) {
    pc_factor(PC_PASS m, t, round == 0u);
    pc_tree_sweep(PC_PASS m, t, TREE_C, TREE_PIN, one);
    if (round == 3u) break;  // what acts is what the factor knows of
    Real changed = pc_revise(PC_PASS m, t, round == 0u);
    if (!PC_ANY(changed > PC_REAL(0.5))) break;  // lint: allow (a lane that is done computes the same again)
    PC_UP(k, t) {
      Slot n = PC_NODE(m, t.first + k);
      Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
      PC_ST(tree_rows, up, TREE_STALE, pc_max(PC_LD(tree_rows, up, TREE_STALE), PC_LD(tree_rows, n, TREE_STALE)));
    }
  }
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st3_tree(PC_PASS n, TREE_LIMIT, pc_row_impulses(PC_PASS t, n, k));
    pc_rates_left(PC_PASS n, PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
  }
  pc_tree_apply(PC_PASS m, t, outside.push, outside.turn);
}
