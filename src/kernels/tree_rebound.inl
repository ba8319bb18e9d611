// What a tree's limits throw back makes no energy. Newton's law leaves each row at a share of its own approach; where
// several are met at once, with shares of their own, or what one throws drives another that leans on its limit, that
// may be more than there was. No more comes back than the solve took, which stops all of them; what exceeds it is left
// out of the whole throw, and pins close in a step of their own.

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
// What a limit throws back is a blow to its whole tree, and no acceleration (half_changes.inl): but for gravity it counts as if it had been there
// before.
PC_FN void pc_tell_blow(PC_IO Slot m, Tree t, Mask these) {
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 fall = pc_scale(gravity, PC_INFO(h));
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index body = PC_ENDS(tree_ends, n, 0u);
    BodyState b = pc_body_state(PC_PASS body);
    Quad linear = PC_GATHER(velocity_parts, body, 0u);
    Quad angular = PC_GATHER(velocity_parts, body, 1u);
    Mask moves = pc_and(these, PC_LD(tree_rows, n, TREE_MASS) > PC_REAL(0.0));
    PC_SCATTER_IF(moves, velocity_parts, body, 0u, pc_quad(pc_sub(b.v, fall), linear.s));
    PC_SCATTER_IF(moves, velocity_parts, body, 1u, pc_quad(b.l, angular.s));
  }
}
// The share of what came since pc_keep_motion that may stay, where a limit has thrown back.
PC_FN Real pc_rebound_share(PC_IO Slot m, Tree t) {
  PC_MEET;
  Real zero = PC_REAL(0.0);
  Real first = zero;
  Real second = zero;
  Real kept_energy = zero;
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
    Six kept = pc_ld6_tree(PC_PASS n, TREE_KEPT_MOTION);
    Vec3 dv = pc_sub(b.v, kept.l);
    Vec3 dl = pc_sub(b.l, kept.a);
    Vec3 dw = pc_sym_mul(b.inertia, dl);
    Vec3 w = pc_sym_mul(b.inertia, kept.a);
    Real turned = pc_dot(w, pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), dw));
    precise Real one = pc_dot(kept.l, dv) * PC_LD(tree_rows, n, TREE_MASS) + turned;
    Mask moves = PC_LD(tree_rows, n, TREE_MASS) > zero;
    precise Real all_first = first + pc_select(moves, one, zero);
    precise Real all_second = second + pc_select(moves, pc_node_energy(PC_PASS n, dv, dw), zero);
    first = all_first;
    second = all_second;
    precise Real all = kept_energy + pc_select(moves, pc_node_energy(PC_PASS n, kept.l, w), zero);
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
// (a share of none is what was, whatever there is now)
PC_FN Vec3 pc_share_since(Vec3 before, Vec3 now, Real share) {
  return pc_select3(share > PC_REAL(0.0), pc_madd(before, pc_sub(now, before), share), before);
}
// Of what came since pc_keep_motion a share stays, and no limit throws back any more.
PC_FN void pc_take_back(PC_IO Slot m, Tree t, Real share, Mask these) {
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index body = PC_ENDS(tree_ends, n, 0u);
    Quad linear = PC_GATHER(motion, body, 0u);
    Quad angular = PC_GATHER(motion, body, 1u);
    Six kept = pc_ld6_tree(PC_PASS n, TREE_KEPT_MOTION);
    Mask moves = pc_and(these, linear.s > PC_REAL(0.0));
    PC_SCATTER_IF(moves, motion, body, 0u, pc_quad(pc_share_since(kept.l, linear.v, share), linear.s));
    PC_SCATTER_IF(moves, motion, body, 1u, pc_quad(pc_share_since(kept.a, angular.v, share), angular.s));
    if (k > 0u) {
      Six pushes = pc_six(pc_ld3_tree(PC_PASS n, TREE_KEPT_PIN), pc_ld3_tree(PC_PASS n, TREE_KEPT_LIMIT));
      Vec3 pin = pc_ld3_tree(PC_PASS n, TREE_PIN);
      Vec3 limit = pc_ld3_tree(PC_PASS n, TREE_LIMIT);
      pc_st3_tree(PC_PASS n, TREE_PIN, pc_select3(these, pc_share_since(pushes.l, pin, share), pin));
      pc_st3_tree(PC_PASS n, TREE_LIMIT, pc_select3(these, pc_share_since(pushes.a, limit, share), limit));
      Vec3 rebound = pc_ld3_tree(PC_PASS n, TREE_REBOUND);
      pc_st3_tree(PC_PASS n, TREE_REBOUND, pc_select3(these, pc_zero3(), rebound));
    }
  }
}
