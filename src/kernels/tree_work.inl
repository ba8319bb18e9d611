// What joints do to a tree's energy. Pins do no work; over a sub-step their impulses J do, since the arms turn
// meanwhile:
//   W = J . (v0 + v1) / 2, v0 and v1 the velocities of the sub-steps before and after,
// a term of third order in what the arms turn by, whose sum over the sub-steps stays of second order while they are
// resolved. Where they are not (a whip, a chain that snaps straight, limits that throw back together), it has either
// sign and any size. So its sum is kept with the tree's first joint, between minus and plus `joint_work` times the
// tree's kinetic energy (and what gravity makes of rest in a sub-step), and what is beyond is taken out of the motion
// within the tree: of a free one without its momenta, of one that hangs on something against that. A motion scaled as
// a whole strains no joint.
//
// All by TREE_TOTAL. After pc_tree_conserve, before the changes are added.

// Of a motion as one rigid body about the root's centre: that of what the tree hangs on, or the mean of a free one after the changes.
struct Frame { Vec3 v; Vec3 w; };
PC_FN Vec3 pc_frame_velocity(Frame f, Vec3 place) { return pc_add(f.v, pc_cross(f.w, place)); }

PC_FN Frame pc_tree_frame(PC_IO Slot m, Tree t) {
  Slot root = PC_NODE(m, t.first);
  BodyState held = pc_body_state(PC_PASS PC_ENDS(tree_ends, root, 0u));
  Mask free = PC_LD(tree_rows, root, TREE_MASS) > PC_REAL(0.0);
  Frame f;
  f.v = held.v;
  f.w = pc_angular_velocity(held);
  if (!PC_ANY(free)) return f;  // lint: allow (selected below)
  Vec3 push = pc_zero3();
  Vec3 turn = pc_zero3();
  Real share = pc_inverse_or_zero(PC_LD(tree_rows, root, TREE_TOTAL));
  PC_ALL(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
    Vec3 p = pc_scale(pc_add(b.v, pc_ld3_tree(PC_PASS n, TREE_X)), PC_LD(tree_rows, n, TREE_MASS));
    Vec3 l = pc_madd(pc_ld3_tree(PC_PASS n, TREE_CHANGE), b.l, share);
    push = pc_add(push, p);
    precise Vec3 all = turn + l + pc_cross(pc_ld3_tree(PC_PASS n, TREE_PLACE), p);
    turn = all;
  }
  Vec3 centre = pc_ld3_tree(PC_PASS root, TREE_CENTRE);
  Vec3 w = pc_sym_mul(pc_lds_tree(PC_PASS root, TREE_RIGID), pc_sub(turn, pc_cross(centre, push)));
  Vec3 v = pc_sub(pc_scale(push, PC_LD(tree_rows, root, TREE_ALL)), pc_cross(w, centre));
  f.v = pc_select3(free, v, f.v);
  f.w = pc_select3(free, w, f.w);
  return f;
}

// Kinetic energy within the frame before and after the changes, and the work of the joints.
struct TreeWork { Real before; Real after; Real work; };
PC_FN TreeWork pc_node_work(PC_IO Slot n, Frame f, TreeWork sum) {
  BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
  Real mass = PC_LD(tree_rows, n, TREE_MASS);
  Real total = PC_LD(tree_rows, n, TREE_TOTAL);
  Vec3 x = pc_ld3_tree(PC_PASS n, TREE_X);
  Vec3 change = pc_ld3_tree(PC_PASS n, TREE_CHANGE);
  Six outside = pc_ld6_tree(PC_PASS n, TREE_OUTSIDE);
  Vec3 v0 = pc_sub(b.v, pc_frame_velocity(f, pc_ld3_tree(PC_PASS n, TREE_PLACE)));
  Vec3 v1 = pc_add(v0, x);
  Vec3 turn = pc_scale(pc_sym_mul(b.inertia, change), total);
  Vec3 w0 = pc_sub(pc_angular_velocity(b), f.w);
  Vec3 w1 = pc_add(w0, turn);
  Sym3 inertia = pc_lds_tree(PC_PASS n, TREE_BODY);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 mean = pc_scale(pc_add(v0, v1), PC_REAL(0.5));
  Vec3 spin = pc_scale(pc_add(w0, w1), PC_REAL(0.5));
  precise Real half_h = PC_INFO(h) * PC_REAL(-0.5);
  Vec3 unkicked = pc_madd(mean, gravity, half_h);
  precise Real before = sum.before + (pc_dot(v0, v0) * mass + pc_dot(w0, pc_sym_mul(inertia, w0))) * PC_REAL(0.5);
  precise Real after = sum.after + (pc_dot(v1, v1) * mass + pc_dot(w1, pc_sym_mul(inertia, w1))) * PC_REAL(0.5);
  precise Real given = pc_dot(outside.l, mean) + pc_dot(outside.a, spin);
  precise Real work = sum.work + (pc_dot(x, unkicked) * mass + pc_dot(change, spin) - given);
  Mask moves = mass > PC_REAL(0.0);
  TreeWork r;
  r.before = pc_select(moves, before, sum.before);
  r.after = pc_select(moves, after, sum.after);
  r.work = pc_select(moves, work, sum.work);
  return r;
}
// The motion of a node within the frame, scaled.
PC_FN void pc_scale_motion(PC_IO Slot n, Frame f, Real scale) {
  BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
  Real share = pc_inverse_or_zero(PC_LD(tree_rows, n, TREE_TOTAL));
  Vec3 frame = pc_frame_velocity(f, pc_ld3_tree(PC_PASS n, TREE_PLACE));
  Vec3 x = pc_ld3_tree(PC_PASS n, TREE_X);
  Vec3 change = pc_ld3_tree(PC_PASS n, TREE_CHANGE);
  Vec3 within = pc_sub(pc_add(b.v, x), frame);
  Vec3 momentum = pc_sub(pc_madd(change, b.l, share), pc_sym_mul(pc_lds_tree(PC_PASS n, TREE_BODY), f.w));
  precise Real less = scale - PC_REAL(1.0);
  pc_st3_tree(PC_PASS n, TREE_X, pc_madd(x, within, less));
  pc_st3_tree(PC_PASS n, TREE_CHANGE, pc_madd(change, momentum, less));
}
// Keeps the account, and the motion within its bounds.
PC_FN void pc_bound_work(PC_IO Slot m, Tree t) {
  if (pc_is_pivot(PC_PASS t) == 1u) return;
  Slot root = PC_NODE(m, t.first);
  PC_MEET;
  Frame f = pc_tree_frame(PC_PASS m, t);
  TreeWork sum;
  sum.before = PC_REAL(0.0);
  sum.after = PC_REAL(0.0);
  sum.work = PC_REAL(0.0);
  PC_ALL(k, 0u, t) sum = pc_node_work(PC_PASS PC_NODE(m, t.first + k), f, sum);
  Mask counts = PC_LD(tree_rows, root, TREE_DRIVEN) < PC_REAL(0.5);
  Vec3 kick = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  precise Real fall = pc_dot(kick, kick) * PC_INFO(h) * PC_INFO(h);
  precise Real most = sum.before * PC_INFO(joint_work) + fall;
  precise Real least = -most;
  precise Real all = PC_LD(tree_rows, root, TREE_ACCOUNT) + sum.work;
  precise Real beyond = all - most;
  Real excess = pc_select(counts, pc_min(pc_max(beyond, PC_REAL(0.0)), sum.after), PC_REAL(0.0));
  PC_MEET;
  PC_ONE PC_ST(tree_rows, root, TREE_ACCOUNT, pc_select(counts, pc_clamp(all, least, most), PC_REAL(0.0)));
  if (!PC_ANY(excess > PC_REAL(0.0))) return;  // lint: allow (a scale of 1 changes nothing)
  precise Real kept = PC_REAL(1.0) - excess * pc_inverse_or_zero(sum.after);
  Real scale = pc_sqrt(pc_max(kept, PC_REAL(0.0)));
  PC_NODES(k, 0u, t) pc_scale_motion(PC_PASS PC_NODE(m, t.first + k), f, scale);
}
