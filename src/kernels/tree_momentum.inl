// Keeps both momenta of a free tree. What a sweep changes satisfies the pins, but its torques are those of an inertia
// with geometric stiffness in it, and of arms at the start of the sub-step: the sum of angular momenta is off by a term
// of second order. It is taken out as a motion of the whole tree as one rigid body, which strains no joint. What came
// from outside, as an impulse and a moment about the root's centre of mass, stays. Before:
// TREE_X holds the changes of velocity, TREE_CHANGE those of angular momentum, TREE_PLACE where the bodies are.
PC_FN void pc_tree_conserve(PC_IO Slot m, Tree t, Vec3 given_push, Vec3 given_turn) {
  Slot root = PC_NODE(m, t.first);
  Mask free = PC_LD(tree_rows, root, TREE_MASS) > PC_REAL(0.0);
  if (!PC_ANY(free)) return;  // lint: allow (what it would do to trees with a fixed root is nothing)
  Vec3 push = pc_negate(given_push);
  Vec3 turn = pc_negate(given_turn);
  PC_MEET;
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 r = pc_ld3_tree(PC_PASS n, TREE_PLACE);
    Vec3 p = pc_scale(pc_ld3_tree(PC_PASS n, TREE_X), PC_LD(tree_rows, n, TREE_MASS));
    push = pc_add(push, p);
    precise Vec3 all = turn + pc_ld3_tree(PC_PASS n, TREE_CHANGE) + pc_cross(r, p);
    turn = all;
  }
  PC_MEET;
  Vec3 centre = pc_ld3_tree(PC_PASS root, TREE_CENTRE);
  Vec3 drift = pc_scale(push, PC_LD(tree_rows, root, TREE_ALL));
  Vec3 w = pc_sym_mul(pc_lds_tree(PC_PASS root, TREE_RIGID), pc_sub(turn, pc_cross(centre, push)));
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Vec3 r = pc_sub(pc_ld3_tree(PC_PASS n, TREE_PLACE), centre);
    Vec3 rate = pc_ld3_tree(PC_PASS n, TREE_X);
    Vec3 change = pc_ld3_tree(PC_PASS n, TREE_CHANGE);
    precise Vec3 v = rate - drift - pc_cross(w, r);
    precise Vec3 l = change - pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), w);
    pc_st3_tree(PC_PASS n, TREE_X, pc_select3(free, v, rate));
    pc_st3_tree(PC_PASS n, TREE_CHANGE, pc_select3(free, l, change));
  }
}

// Adds the changes to the bodies' velocities and momenta, of `some` trees; and that contacts touched them.
PC_FN void pc_tree_move(PC_IO Slot m, Tree t, Mask some) {
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index body = PC_ENDS(tree_ends, n, 0u);
    Quad linear = PC_GATHER(motion, body, 0u);
    Quad angular = PC_GATHER(motion, body, 1u);
    angular.s = pc_max(angular.s, PC_LD(tree_rows, n, TREE_TOUCH));
    linear.v = pc_add(linear.v, pc_ld3_tree(PC_PASS n, TREE_X));
    angular.v = pc_madd(angular.v, pc_ld3_tree(PC_PASS n, TREE_CHANGE), PC_LD(tree_rows, n, TREE_TOTAL));
    Mask moves = pc_and(some, linear.s > PC_REAL(0.0));
    PC_SCATTER_IF(moves, motion, body, 0u, linear);
    PC_SCATTER_IF(moves, motion, body, 1u, angular);
  }
}
// The same, both momenta of a free tree kept.
PC_FN void pc_tree_add_changes_of(PC_IO Slot m, Tree t, Mask some, Vec3 given_push, Vec3 given_turn) {
  pc_tree_conserve(PC_PASS m, t, given_push, given_turn);
  pc_tree_move(PC_PASS m, t, some);
}
PC_FN void pc_tree_add_changes(PC_IO Slot m, Tree t, Vec3 given_push, Vec3 given_turn) {
  pc_tree_add_changes_of(PC_PASS m, t, PC_IS(1u), given_push, given_turn);
}

// What undoes gaps and overlaps, so far: it is taken back once the bodies have moved.
PC_FN void pc_add_to_push(PC_IO Slot n) {
  pc_st3_tree(PC_PASS n, TREE_PUSH_SPEED,
              pc_add(pc_ld3_tree(PC_PASS n, TREE_PUSH_SPEED), pc_ld3_tree(PC_PASS n, TREE_X)));
  pc_st3_tree(PC_PASS n, TREE_PUSH_TURN,
              pc_add(pc_ld3_tree(PC_PASS n, TREE_PUSH_TURN), pc_ld3_tree(PC_PASS n, TREE_CHANGE)));
}

// Adds what a sweep changed to the bodies' velocities. Velocities themselves, not the impulses: those act on light
// bodies between heavy ones as the difference of large numbers.
PC_FN void pc_tree_apply(PC_IO Slot m, Tree t, Vec3 given_push, Vec3 given_turn) {
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    pc_st3_tree(PC_PASS n, TREE_CHANGE,
                pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), pc_ld3_tree(PC_PASS n, TREE_X + 3u)));
  }
  pc_tree_add_changes(PC_PASS m, t, given_push, given_turn);
}
