// Solving with a tree's factor, and what its impulses do to the bodies.
//
// A child moves as x = X x_parent + S q - (c, 0): X x = (l + a x d, a) with d = r_p - r_c, S q = (r_c x q, q), q the
// relative rotation and c what the pin must undo. With H the articulated inertia (R. Featherstone, Rigid Body Dynamics
// Algorithms, 2008, chapter 7), U = H S, D = S^T U + springs, W = U D^-1, H' = H - W U^T:
//   up:   t = S^T F + springs' push, F_parent += X^T (F - W t + H' (c, 0))
//   down: a = X x_parent - (c, 0), q = D^-1 t - W^T a, x = a + S q; pin impulse = linear part of H' a + W t - F
// The root: x = H^-1 F, or 0 where it is fixed.

PC_FN Six pc_w_mul(PC_IO Slot n, Vec3 t) {
  return pc_six(Vec3(pc_dot(pc_ld3_tree(PC_PASS n, TREE_W), t), pc_dot(pc_ld3_tree(PC_PASS n, TREE_W + 3u), t),
                     pc_dot(pc_ld3_tree(PC_PASS n, TREE_W + 6u), t)),
                Vec3(pc_dot(pc_ld3_tree(PC_PASS n, TREE_W + 9u), t), pc_dot(pc_ld3_tree(PC_PASS n, TREE_W + 12u), t),
                     pc_dot(pc_ld3_tree(PC_PASS n, TREE_W + 15u), t)));
}
// t of a node: what is collected there, and the springs of its angle rows where `limits` is 1.
PC_FN Vec3 pc_joint_push(PC_IO Slot n, Six f, Vec3 rc, Real limits) {
  precise Vec3 t = f.a + pc_cross(f.l, rc);
#ifdef PC_DRIVES
  if (PC_ANY(pc_has_drive(PC_PASS n))) {  // lint: allow (zeros otherwise)
    t = pc_sub(t, pc_select3(pc_has_drive(PC_PASS n), pc_ld3_drive(PC_PASS n, DRIVE_PUSH), pc_zero3()));
  }
#endif
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return t;  // lint: allow (zeros otherwise)
  precise Real s0 = PC_LD(tree_rows, n, TREE_SPRING) * PC_LD(tree_rows, n, TREE_RATE) * limits;
  precise Real s1 = PC_LD(tree_rows, n, TREE_SPRING + 1u) * PC_LD(tree_rows, n, TREE_RATE + 1u) * limits;
  precise Real s2 = PC_LD(tree_rows, n, TREE_SPRING + 2u) * PC_LD(tree_rows, n, TREE_RATE + 2u) * limits;
  return pc_sub(t, pc_combine(pc_ld3_tree(PC_PASS n, TREE_AXIS), s0, pc_ld3_tree(PC_PASS n, TREE_AXIS + 3u), s1,
                              pc_ld3_tree(PC_PASS n, TREE_AXIS + 6u), s2));
}
// Fills TREE_X of all nodes and, at `pin`, the impulses of the pins, from the right-hand sides at `c`.
PC_FN void pc_tree_sweep(PC_IO Slot m, Tree t, uint c, uint pin, Real limits) {
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Six outside = pc_ld6_tree(PC_PASS n, TREE_OUTSIDE);
    pc_st6_tree(PC_PASS n, TREE_F, outside);
  }
  PC_MEET;
  PC_UP(k, t) {
    Slot n = PC_NODE(m, t.first + k);
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    Six f = pc_ld6_tree(PC_PASS n, TREE_F);
    Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
    Vec3 gap = pc_ld3_tree(PC_PASS n, c);
    Vec3 push = pc_joint_push(PC_PASS n, f, rc, limits);
    Six w = pc_w_mul(PC_PASS n, push);
    // for the way down
    pc_st3_tree(PC_PASS n, TREE_F + 3u, push);
    pc_st3_tree(PC_PASS n, TREE_X, w.l);
    precise Vec3 l = f.l - w.l + pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_A), gap);
    precise Vec3 a = f.a - w.a + pc_mat_tmul(pc_ldm_tree(PC_PASS n, TREE_A + 6u), gap);
    Vec3 d = pc_sub(pc_ld3_tree(PC_PASS n, TREE_RP), rc);
    Six sum = pc_ld6_tree(PC_PASS up, TREE_F);
    precise Vec3 sum_a = sum.a + a + pc_cross(d, l);
    pc_st6_tree(PC_PASS up, TREE_F, pc_six(pc_add(sum.l, l), sum_a));
  }
  Slot root = PC_NODE(m, t.first);
  PC_ONE pc_st6_tree(PC_PASS root, TREE_X,
                     pc_sym6_mul(pc_ldh_tree(PC_PASS root, TREE_H), pc_ld6_tree(PC_PASS root, TREE_F)));
  PC_MEET;
  PC_DOWN(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    Six f = pc_ld6_tree(PC_PASS n, TREE_F);
    Vec3 w = pc_ld3_tree(PC_PASS n, TREE_X);
    Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
    Six above = pc_ld6_tree(PC_PASS up, TREE_X);
    Vec3 d = pc_sub(pc_ld3_tree(PC_PASS n, TREE_RP), rc);
    precise Vec3 l = above.l + pc_cross(above.a, d) - pc_ld3_tree(PC_PASS n, c);
    Six a = pc_six(l, above.a);
    Vec3 q = pc_sub(pc_factor_mul(pc_lds_tree(PC_PASS n, TREE_D), f.a), pc_w_tmul(PC_PASS n, TREE_W, a));
    pc_st6_tree(PC_PASS n, TREE_X, pc_six(pc_add(l, pc_cross(rc, q)), pc_add(above.a, q)));
    precise Vec3 impulse = pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_A), l) +
                           pc_mat_mul(pc_ldm_tree(PC_PASS n, TREE_A + 6u), above.a) + w - f.l;
    pc_st3_tree(PC_PASS n, pin, impulse);
  }
}

// Impulse of angle row i after a sweep, along its axis: -spring (rate + change of rate).
PC_FN Real pc_row_impulse(PC_IO Slot n, uint i, Vec3 turn) {
  precise Real impulse = -PC_LD(tree_rows, n, TREE_SPRING + i) * pc_rate_after(PC_PASS n, i, turn);
  return impulse;
}

// Impulses of the three angle rows after a sweep.
PC_FN Vec3 pc_row_impulses(PC_IO Tree t, Slot n, uint k) {
  if (!PC_ANY(pc_has_rows(PC_PASS n))) return pc_zero3();  // lint: allow (zeros otherwise)
  Slot up = PC_NODE(n, t.first + pc_parent(PC_PASS t, k));
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  return Vec3(pc_row_impulse(PC_PASS n, 0u, turn), pc_row_impulse(PC_PASS n, 1u, turn),
              pc_row_impulse(PC_PASS n, 2u, turn));
}
