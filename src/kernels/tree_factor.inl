// The factor of a tree, leaves to root (see tree_sweep.inl). Where an active set has changed, it is made anew of the
// joints that changed and of those between them and the root.

// while tree_solve and tree_limits last, in places that are free by then
const uint TREE_REST = TREE_PUSH;       // the angular part of TREE_A, 6
const uint TREE_STALE = TREE_KEPT_PIN;  // 1 where the factor must be made anew
// Of a joint's inertia, in units of PC_INFO(rounding), what is lost in it of a light body's turning; and where
// stiffness is not known.
#define PC_SPIN_LOST PC_REAL(16.0)
#define PC_SPIN_UNKNOWN PC_REAL(256.0)

PC_FN Mask pc_is_stale(PC_IO Slot n) { return PC_LD(tree_rows, n, TREE_STALE) > PC_REAL(0.5); }

// The factor of a joint's freedom (pc_inverse_factor) with the springs of its angle rows: each as stiff as the joint's
// own inertia about its axis, many times. The limit of a hinge, whose other angles are locked, is as stiff as they are:
// a stop. Limits of joints with more freedom yield: stiff ones that meet at an angle tear trees apart.
PC_FN Sym3 pc_with_springs(PC_IO Slot n, Sym3 loose) {
  Sym3 factor = loose;
  precise Real others = PC_LD(tree_rows, n, TREE_KIND) + PC_LD(tree_rows, n, TREE_KIND + 1u) +
                        PC_LD(tree_rows, n, TREE_KIND + 2u) - PC_REAL(2.0);
  for (uint i = 0u; i < 3u; i++) {
    Vec3 j = pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u);
    Mask stops = pc_or(PC_LD(tree_rows, n, TREE_KIND + i) > PC_REAL(1.0), others > PC_REAL(2.0));
    Real stiffness = pc_select(stops, PC_INFO(lock_stiffness), PC_INFO(limit_stiffness));
    precise Real on = PC_LD(tree_rows, n, TREE_ON + i);
    precise Real stiff = stiffness * on * pc_inverse_or_zero(pc_dot(j, pc_factor_mul(loose, j)));
    Real spring = pc_select(on > PC_REAL(0.0), stiff, PC_REAL(0.0));
    PC_ST(tree_rows, n, TREE_SPRING + i, spring);
    factor = pc_factor_stiffened(factor, j, spring);
  }
  return factor;
}
// The smallest of a body's moments of inertia.
PC_FN Real pc_least_moment(PC_IO Slot n) {
  Vec3 inverse = pc_ld3_tree(PC_PASS n, TREE_MOMENTS);
  precise Real light = pc_max(inverse.x, pc_max(inverse.y, inverse.z)) * PC_LD(tree_rows, n, TREE_TOTAL);
  return pc_inverse_or_zero(light);
}
// A light body's turning between heavy ones is lost in the rounding of their inertia. What its own inertia about its
// pin lacks of `lost` is added along each of its principal axes: where it lacks nothing it would be inertia that
// nothing has, and energy goes into that.
PC_FN Sym3 pc_add_about(PC_IO Slot n, Sym3 m, Vec3 axis, Real inverse, Vec3 arm, Real lost) {
  precise Real light = inverse * PC_LD(tree_rows, n, TREE_TOTAL);
  Vec3 across = pc_cross(axis, arm);
  precise Real own = pc_inverse_or_zero(light) + pc_dot(across, across) * PC_LD(tree_rows, n, TREE_MASS);
  precise Real lacks = lost - own;
  return pc_sym_outer(m, axis, pc_max(lacks, PC_REAL(0.0)));
}
PC_FN Sym3 pc_with_lost_inertia(PC_IO Slot n, Sym3 m, Vec3 arm, Real lost) {
  Vec3 inverse = pc_ld3_tree(PC_PASS n, TREE_MOMENTS);
  Real one = PC_REAL(1.0);
  Real none = PC_REAL(0.0);
  Quaternion q = pc_quaternion(pc_ld3_tree(PC_PASS n, TREE_FACING), PC_LD(tree_rows, n, TREE_FACING + 3u));
  m = pc_add_about(PC_PASS n, m, pc_rotate(q, Vec3(one, none, none)), inverse.x, arm, lost);
  m = pc_add_about(PC_PASS n, m, pc_rotate(q, Vec3(none, one, none)), inverse.y, arm, lost);
  return pc_add_about(PC_PASS n, m, pc_rotate(q, Vec3(none, none, one)), inverse.z, arm, lost);
}
// The inertia m of a joint's freedom with the floors under it: what rounding loses, and a share of all where pins are
// stiffer than the sub-step follows (`fast`, TREE_FAST). What turns about its pin alone stands between nothing: a floor
// would take its share of each kick.
PC_FN Sym3 pc_with_floor(PC_IO Slot n, Sym3 m, Vec3 arm, Real fast) {
  precise Real all = m.xx + m.yy + m.zz;
  precise Real known = all * PC_INFO(rounding) * PC_SPIN_LOST;
  // pins that remember no impulse may be of any stiffness
  precise Real unknown = all * PC_INFO(rounding) * PC_SPIN_UNKNOWN;
#ifdef PC_DRIVES
  precise Real driven = all * PC_INFO(rounding);
  unknown = pc_select(pc_drive_lasts(PC_PASS n), driven, unknown);
#endif
  precise Real stiff = all * fast * PC_INFO(spin_floor);
  precise Real least = all * PC_EPSILON;
  Mask pivot = PC_LD(tree_rows, n, TREE_PIVOT) > PC_REAL(0.5);
  Real lost = pc_select(pivot, PC_REAL(0.0), pc_select(fast > PC_REAL(0.0), known, unknown));
  Sym3 held = pc_sym_add(m, pc_diagonal(pc_select(pivot, least, stiff)));
  Mask lacks = lost > pc_least_moment(PC_PASS n);
  if (!PC_ANY(lacks)) return held;  // lint: allow (others lack nothing)
  return pc_sym_select(lacks, pc_with_lost_inertia(PC_PASS n, held, arm, lost), held);
}
#ifdef PC_SEEN
// Where W is made anew after the contacts they go on seeing it as it was.
PC_FN void pc_keep_seen(PC_IO Slot n) {
  Mask anew = pc_is_stale(PC_PASS n);
  for (uint i = 0u; i < 18u; i++)
    PC_ST(tree_rows, n, TREE_SEEN + i,
          pc_select(anew, PC_LD(tree_rows, n, TREE_W + i), PC_LD(tree_rows, n, TREE_SEEN + i)));
}
#endif
// The parent carries `rest` of a node's inertia (pc_factor_node), shifted to its own place.
PC_FN void pc_carry(PC_IO Slot n, Slot up, uint parent, Sym6 rest) {
  Mask free = PC_LD(tree_rows, up, TREE_MASS) > PC_REAL(0.0);
  if (parent == 0u && !PC_ANY(free)) return;  // lint: allow (of a fixed root it is not used)
  Vec3 d = pc_sub(pc_ld3_tree(PC_PASS n, TREE_RP), pc_ld3_tree(PC_PASS n, TREE_RC));
  pc_sth_tree(PC_PASS up, TREE_H, pc_sym6_add(pc_ldh_tree(PC_PASS up, TREE_H), pc_sym6_shift(rest, d)));
}
// Factors a node; what is left of its inertia, H - W U^T, its parent carries.
PC_FN Sym6 pc_factor_node(PC_IO Slot n, Slot up) {
  Real fast = pc_max(PC_LD(tree_rows, n, TREE_FAST), PC_LD(tree_rows, up, TREE_FAST));
  Sym6 h = pc_ldh_tree(PC_PASS n, TREE_H);
  Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
  Mat3 ct = pc_transpose(h.c);
  // U = H S
  Vec3 u0 = pc_add(h.c.a, pc_cross(pc_row0(h.l), rc));
  Vec3 u1 = pc_add(h.c.b, pc_cross(pc_row1(h.l), rc));
  Vec3 u2 = pc_add(h.c.c, pc_cross(pc_row2(h.l), rc));
  Vec3 u3 = pc_add(pc_row0(h.a), pc_cross(ct.a, rc));
  Vec3 u4 = pc_add(pc_row1(h.a), pc_cross(ct.b, rc));
  Vec3 u5 = pc_add(pc_row2(h.a), pc_cross(ct.c, rc));
  // S^T U
  precise Real xx = u3.x + u1.x * rc.z - u2.x * rc.y;
  precise Real xy = u3.y + u1.y * rc.z - u2.y * rc.y;
  precise Real xz = u3.z + u1.z * rc.z - u2.z * rc.y;
  precise Real yy = u4.y + u2.y * rc.x - u0.y * rc.z;
  precise Real yz = u4.z + u2.z * rc.x - u0.z * rc.z;
  precise Real zz = u5.z + u0.z * rc.y - u1.z * rc.x;
  Sym3 freedom = pc_with_floor(PC_PASS n, pc_sym3(xx, xy, xz, yy, yz, zz), rc, fast);
  Sym3 factor = pc_inverse_factor(freedom);
#ifdef PC_DRIVES
  if (PC_ANY(pc_has_drive(PC_PASS n))) {  // lint: allow (others keep what they have)
    freedom = pc_with_drives(PC_PASS n, up, freedom, pc_of_factor(factor));
    factor = pc_sym_select(pc_has_drive(PC_PASS n), pc_inverse_factor(freedom), factor);
  }
#endif
  Mask has_rows = pc_has_rows(PC_PASS n);
  if (PC_ANY(has_rows)) {  // lint: allow (others keep what they have)
    factor = pc_sym_select(has_rows, pc_with_springs(PC_PASS n, factor), factor);
  }
  // W = U E^T d E, and U D^-1 U^T of the same halves
  Vec3 y0 = pc_factor_lower(factor, u0);
  Vec3 y1 = pc_factor_lower(factor, u1);
  Vec3 y2 = pc_factor_lower(factor, u2);
  Vec3 y3 = pc_factor_lower(factor, u3);
  Vec3 y4 = pc_factor_lower(factor, u4);
  Vec3 y5 = pc_factor_lower(factor, u5);
  Vec3 z0 = pc_factor_scaled(factor, y0);
  Vec3 z1 = pc_factor_scaled(factor, y1);
  Vec3 z2 = pc_factor_scaled(factor, y2);
  Vec3 z3 = pc_factor_scaled(factor, y3);
  Vec3 z4 = pc_factor_scaled(factor, y4);
  Vec3 z5 = pc_factor_scaled(factor, y5);
#ifdef PC_SEEN
  pc_keep_seen(PC_PASS n);
#endif
  pc_sts_tree(PC_PASS n, TREE_D, factor);
  pc_stm_tree(PC_PASS n, TREE_W,
              pc_mat3(pc_factor_upper(factor, z0), pc_factor_upper(factor, z1), pc_factor_upper(factor, z2)));
  pc_stm_tree(PC_PASS n, TREE_W + 9u,
              pc_mat3(pc_factor_upper(factor, z3), pc_factor_upper(factor, z4), pc_factor_upper(factor, z5)));
  // H - W U^T, and what of it the parent carries
  Sym6 rest;
  rest.l = pc_sym_sub(h.l, pc_products(z0, z1, z2, y0, y1, y2));
  rest.a = pc_sym_sub(h.a, pc_products(z3, z4, z5, y3, y4, y5));
  rest.c = pc_mat3(pc_sub(h.c.a, Vec3(pc_dot(z0, y3), pc_dot(z0, y4), pc_dot(z0, y5))),
                   pc_sub(h.c.b, Vec3(pc_dot(z1, y3), pc_dot(z1, y4), pc_dot(z1, y5))),
                   pc_sub(h.c.c, Vec3(pc_dot(z2, y3), pc_dot(z2, y4), pc_dot(z2, y5))));
  pc_sts_tree(PC_PASS n, TREE_A, rest.l);
  pc_stm_tree(PC_PASS n, TREE_A + 6u, rest.c);
#ifndef PC_SEEN
  pc_sts_tree(PC_PASS n, TREE_REST, rest.a);
#endif
  return rest;
}
// `all`: of every node; else of those that are stale, and what others hand to them.
PC_FN void pc_factor(PC_IO Slot m, Tree t, bool all) {
  Vec3 z = pc_zero3();
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    if (all || PC_ANY(pc_is_stale(PC_PASS n))) {  // lint: allow (others keep what they have)
      Sym6 h;
      h.l = pc_diagonal(PC_LD(tree_rows, n, TREE_MASS));
      h.c = pc_mat3(z, z, z);
      h.a = pc_lds_tree(PC_PASS n, TREE_INERTIA);
      pc_sth_tree(PC_PASS n, TREE_H, h);
    }
  }
  PC_MEET;
  PC_UP(k, t) {
    uint parent = pc_parent(PC_PASS t, k);
    Slot n = PC_NODE(m, t.first + k);
    Slot up = PC_NODE(m, t.first + parent);
    if (!all && !PC_ANY(pc_is_stale(PC_PASS up))) continue;  // lint: allow (others keep what they have)
    Sym6 rest;
    if (all || PC_ANY(pc_is_stale(PC_PASS n))) {  // lint: allow (as above)
      rest = pc_factor_node(PC_PASS n, up);
    } else {
      rest.l = pc_lds_tree(PC_PASS n, TREE_A);
      rest.c = pc_ldm_tree(PC_PASS n, TREE_A + 6u);
      rest.a = pc_lds_tree(PC_PASS n, TREE_REST);
    }
    pc_carry(PC_PASS n, up, parent, rest);
  }
  // a fixed root answers nothing
  Slot root = PC_NODE(m, t.first);
  Mask free = PC_LD(tree_rows, root, TREE_MASS) > PC_REAL(0.0);
  Sym6 r;
  Sym3 none = pc_diagonal(PC_REAL(0.0));
  r.l = none;
  r.c = pc_mat3(z, z, z);
  r.a = none;
  if (PC_ANY(free)) {  // lint: allow (other lanes keep what they have)
    Sym6 h = pc_sym6_inverse(pc_ldh_tree(PC_PASS root, TREE_H));
    r.l = pc_sym_select(free, h.l, none);
    r.a = pc_sym_select(free, h.a, none);
    r.c = pc_mat3(pc_select3(free, h.c.a, z), pc_select3(free, h.c.b, z), pc_select3(free, h.c.c, z));
  }
  PC_ONE pc_sth_tree(PC_PASS root, TREE_H, r);
}
