// What a tree's limits throw back makes no energy. Newton's law leaves each row at a share of its own approach; where
// several are met at once, with shares of their own, or what one throws drives another that leans on its limit, that
// may be more than there was. Such a throw, and one that would cross a limit within the sub-step (the other one of its
// joint, or that of another), is late: the sub-step ends at the limits, and bodies have the throw once they have moved.
// Of it no more comes back than the solve took, which stops all of them;
// what exceeds it is left out of the whole throw.

const uint TREE_THROW = TREE_INERTIA;  // change of velocity and of angular momentum; tree_trust.inl is done with it

// Of the energy of a throw, in units of PC_INFO(rounding), what rounding leaves.
#define PC_LIMIT_NOISE PC_REAL(16.0)

// 1 where a limit is met that throws back.
PC_FN Real pc_is_thrown(PC_IO Slot n) {
  Real most = PC_REAL(0.0);
  if (!PC_ANY(pc_throws_back(PC_PASS n))) return most;  // lint: allow (zero otherwise)
  for (uint i = 0u; i < 3u; i++) {
    Mask on = PC_LD(tree_rows, n, TREE_ON + i) > PC_REAL(0.5);
    Mask is_row = PC_LD(tree_rows, n, TREE_KIND + i) > PC_REAL(0.5);
    Mask leaves = PC_LD(tree_rows, n, TREE_REBOUND + i) > PC_REAL(0.0);
    Mask met = pc_and(pc_throws_back(PC_PASS n), pc_and(on, is_row));
    most = pc_max(most, pc_select(pc_and(met, leaves), PC_REAL(1.0), PC_REAL(0.0)));
  }
  return most;
}
PC_FN Real pc_tree_is_thrown(PC_IO Slot m, Tree t) {
  Real most = PC_REAL(0.0);
  PC_NODES(k, 1u, t) most = pc_max(most, pc_is_thrown(PC_PASS PC_NODE(m, t.first + k)));
  PC_MOST(most);
  return most;
}
// Of a limit that is met and throws back, how far `rate` lacks of that at which it is to be left; else 0.
PC_FN Real pc_lacks_rebound(PC_IO Slot n, uint i, Real rate) {
  Real away = PC_LD(tree_rows, n, TREE_REBOUND + i);
  Mask acts =
      pc_and(PC_LD(tree_rows, n, TREE_ON + i) > PC_REAL(0.5), PC_LD(tree_rows, n, TREE_KIND + i) > PC_REAL(0.5));
  Mask rebounds = pc_and(pc_throws_back(PC_PASS n), pc_and(acts, away > PC_REAL(0.0)));
  precise Real lack = rate - away;
  return pc_select(rebounds, pc_min(lack, PC_REAL(0.0)), PC_REAL(0.0));
}
// A limit that throws back is left too slowly where this share of the rate lacks.
#define PC_LACKS_REBOUND PC_REAL(1e-5)
PC_FN Mask pc_lacks_much(PC_IO Slot n, uint i, Real lack) {
  precise Real much = PC_LD(tree_rows, n, TREE_REBOUND + i) * -PC_LACKS_REBOUND;
  return pc_and(lack < PC_REAL(0.0), lack < much);
}
// 1 where a limit is foreseen to be crossed, whether it acts or not, and on either side. Run after pc_tree_residual.
PC_FN Real pc_crosses_any(PC_IO Slot n, Slot up) {
  Real any = PC_REAL(0.0);
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return any;  // lint: allow (zero otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
    Real slack = PC_LD(tree_rows, n, TREE_SLACK + i);
    Real rate = pc_row_ahead(PC_PASS n, up, i, turn, PC_REAL(1.0)).rate;
    precise Real near = rate + pc_max(slack, PC_REAL(0.0)) * PC_INFO(inverse_h);
    precise Real far = (PC_LD(tree_rows, n, TREE_SPAN + i) - slack) * PC_INFO(inverse_h) - rate;
    Mask crossed = pc_and(pc_and(kind > PC_REAL(0.5), kind < PC_REAL(2.0)), pc_is_crossed(pc_min(near, far)));
    any = pc_select(crossed, PC_REAL(1.0), any);
  }
  return any;
}
// 1 where the throw is late.
PC_FN Real pc_throws_too_far(PC_IO Slot m, Tree t) {
  Real far = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    far = pc_max(far, pc_crosses_any(PC_PASS PC_NODE(m, t.first + k), up));
  }
  PC_MOST(far);
  Real now = pc_tree_energy(PC_PASS m, t);
  Real energy = PC_LD(tree_rows, PC_NODE(m, t.first), TREE_ENERGY);
  // (Newton's steps end before rounding in double precision)
  precise Real noise = PC_INFO(rounding) * PC_LIMIT_NOISE;
  precise Real most = energy + energy * pc_max(noise, PC_SLIGHT);
  return pc_select(now > most, PC_REAL(1.0), far);
}
// Rates that the throw has to make up for: first of the limits that throw back, which lack all of it, then what a sweep
// has left, of the others that act too. 1 where a limit is left too slowly by much.
PC_FN Real pc_throw_rates_of(PC_IO Slot n, Slot up, bool first) {
  Real lacks = PC_REAL(0.0);
  pc_st3_tree(PC_PASS n, TREE_C, pc_zero3());
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return lacks;  // lint: allow (zero otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  for (uint i = 0u; i < 3u; i++) {
    Real now = pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
    Real rate = pc_rate_after(PC_PASS n, i, turn);
    if (first) rate = pc_lacks_rebound(PC_PASS n, i, now);
    Mask throws = pc_lacks_rebound(PC_PASS n, i, PC_REAL(0.0)) < PC_REAL(0.0);
    lacks = pc_select(pc_and(throws, pc_lacks_much(PC_PASS n, i, rate)), PC_REAL(1.0), lacks);
    PC_ST(tree_rows, n, TREE_RATE + i, rate);
  }
  return lacks;
}
PC_FN Real pc_throw_rates(PC_IO Slot m, Tree t, bool first) {
  Real lacks = PC_REAL(0.0);
  PC_MEET;
  PC_NODES(k, 1u, t) {
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    lacks = pc_max(lacks, pc_throw_rates_of(PC_PASS PC_NODE(m, t.first + k), up, first));
  }
  PC_MOST(lacks);
  if (first) {
    PC_NODES(k, 0u, t) pc_st6_tree(PC_PASS PC_NODE(m, t.first + k), TREE_THROW, pc_six(pc_zero3(), pc_zero3()));
  }
  return lacks;
}
// After a sweep.
PC_FN void pc_add_to_throw(PC_IO Slot n) {
  pc_st3_tree(PC_PASS n, TREE_THROW, pc_add(pc_ld3_tree(PC_PASS n, TREE_THROW), pc_ld3_tree(PC_PASS n, TREE_X)));
  pc_st3_tree(PC_PASS n, TREE_THROW + 3u,
              pc_add(pc_ld3_tree(PC_PASS n, TREE_THROW + 3u), pc_ld3_tree(PC_PASS n, TREE_CHANGE)));
}
// The share of the throw that may stay.
PC_FN Real pc_rebound_share(PC_IO Slot m, Tree t) {
  PC_MEET;
  Real zero = PC_REAL(0.0);
  Real first = zero;
  Real second = zero;
  Real kept_energy = zero;
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
    Six thrown = pc_ld6_tree(PC_PASS n, TREE_THROW);
    Vec3 dw = pc_sym_mul(b.inertia, pc_scale(thrown.a, PC_LD(tree_rows, n, TREE_TOTAL)));
    Vec3 w = pc_angular_velocity(b);
    Real turned = pc_dot(w, pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), dw));
    precise Real one = pc_dot(b.v, thrown.l) * PC_LD(tree_rows, n, TREE_MASS) + turned;
    Mask moves = PC_LD(tree_rows, n, TREE_MASS) > zero;
    precise Real all_first = first + pc_select(moves, one, zero);
    precise Real all_second = second + pc_select(moves, pc_node_energy(PC_PASS n, thrown.l, dw), zero);
    first = all_first;
    second = all_second;
    precise Real all = kept_energy + pc_select(moves, pc_node_energy(PC_PASS n, b.v, w), zero);
    kept_energy = all;
  }
  PC_MEET;
  Real energy = PC_LD(tree_rows, PC_NODE(m, t.first), TREE_ENERGY);
  precise Real taken = energy - kept_energy;
  // (what one limit gives back whole is within rounding of it)
  precise Real slightly = energy * PC_INFO(rounding) * PC_LIMIT_NOISE;
  Real back = pc_max(taken, zero);
  // 2 share first + share^2 second = back
  precise Real made = first + first + second;
  precise Real inside = first * first + second * back;
  Real root = pc_sqrt(pc_max(inside, zero));
  precise Real both = first + root;
  Real rising = pc_div(back, pc_max(both, PC_TINY));
  precise Real turning = root - first;
  Real falling = pc_div(turning, pc_max(second, PC_TINY));
  Real exact = pc_select(first > zero, rising, falling);
  Real share = pc_select(exact > zero, pc_min(exact, PC_REAL(1.0)), zero);  // none where it is no number
  precise Real most = back + slightly;
  return pc_select(made > most, share, PC_REAL(1.0));
}
// What a limit throws back is a blow to its whole tree, and no acceleration (half_changes.inl): but for gravity it
// counts as if it had been there before.
PC_FN void pc_tell_blow(PC_IO Slot m, Tree t, Mask these, Mask late) {
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 fall = pc_scale(gravity, PC_INFO(h));
  if (pc_is_pivot(PC_PASS t) == 1u) late = PC_IS(0u);  // it has it already
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index body = PC_ENDS(tree_ends, n, 0u);
    BodyState b = pc_body_state(PC_PASS body);
    Quad linear = PC_GATHER(velocity_parts, body, 0u);
    Quad angular = PC_GATHER(velocity_parts, body, 1u);
    Mask moves = pc_and(these, PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0));
    Vec3 v = pc_select3(late, pc_add(b.v, pc_ld3_tree(PC_PASS n, TREE_THROW)), b.v);
    Vec3 l =
        pc_select3(late, pc_madd(b.l, pc_ld3_tree(PC_PASS n, TREE_THROW + 3u), PC_LD(tree_rows, n, TREE_TOTAL)), b.l);
    PC_SCATTER_IF(moves, velocity_parts, body, 0u, pc_quad(pc_sub(v, fall), linear.s));
    PC_SCATTER_IF(moves, velocity_parts, body, 1u, pc_quad(l, angular.s));
  }
}
// Before the push. A body that turns about its pin has it at once: pivot_turn moves it, and takes nothing back.
PC_FN void pc_end_throw(PC_IO Slot m, Tree t, Mask thrown) {
  Real share = pc_rebound_share(PC_PASS m, t);
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 v = pc_scale(pc_ld3_tree(PC_PASS n, TREE_THROW), share);
    Vec3 l = pc_scale(pc_ld3_tree(PC_PASS n, TREE_THROW + 3u), share);
    pc_st6_tree(PC_PASS n, TREE_THROW, pc_six(v, l));
    if (pc_is_pivot(PC_PASS t) == 1u) {
      pc_st3_tree(PC_PASS n, TREE_X, v);
      pc_st3_tree(PC_PASS n, TREE_CHANGE, l);
    }
  }
  if (pc_is_pivot(PC_PASS t) == 1u) pc_tree_move(PC_PASS m, t, thrown);
}
// After the push: the relax phase takes back less, or gives, once the bodies have moved.
PC_FN void pc_push_against_throw(PC_IO Slot m, Tree t, Mask thrown) {
  if (pc_is_pivot(PC_PASS t) == 1u) return;
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 v = pc_select3(thrown, pc_ld3_tree(PC_PASS n, TREE_THROW), pc_zero3());
    Vec3 l = pc_select3(thrown, pc_ld3_tree(PC_PASS n, TREE_THROW + 3u), pc_zero3());
    pc_st3_tree(PC_PASS n, TREE_PUSH_SPEED, pc_sub(pc_ld3_tree(PC_PASS n, TREE_PUSH_SPEED), v));
    pc_st3_tree(PC_PASS n, TREE_PUSH_TURN, pc_sub(pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN), l));
  }
}
