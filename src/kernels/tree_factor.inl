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
// Six rows of three: of the linear part, and of the angular.
struct SixRows {
  Mat3 l;
  Mat3 a;
};
// U = H S.
PC_FN SixRows pc_joint_columns(Sym6 h, Vec3 rc) {
  Mat3 ct = pc_transpose(h.c);
  SixRows u;
  u.l = pc_mat3(pc_add(h.c.a, pc_cross(pc_row0(h.l), rc)), pc_add(h.c.b, pc_cross(pc_row1(h.l), rc)),
                pc_add(h.c.c, pc_cross(pc_row2(h.l), rc)));
  u.a = pc_mat3(pc_add(pc_row0(h.a), pc_cross(ct.a, rc)), pc_add(pc_row1(h.a), pc_cross(ct.b, rc)),
                pc_add(pc_row2(h.a), pc_cross(ct.c, rc)));
  return u;
}
// S^T U.
PC_FN Sym3 pc_joint_inertia(SixRows u, Vec3 rc) {
  precise Real xx = u.a.a.x + u.l.b.x * rc.z - u.l.c.x * rc.y;
  precise Real xy = u.a.a.y + u.l.b.y * rc.z - u.l.c.y * rc.y;
  precise Real xz = u.a.a.z + u.l.b.z * rc.z - u.l.c.z * rc.y;
  precise Real yy = u.a.b.y + u.l.c.y * rc.x - u.l.a.y * rc.z;
  precise Real yz = u.a.b.z + u.l.c.z * rc.x - u.l.a.z * rc.z;
  precise Real zz = u.a.c.z + u.l.a.z * rc.y - u.l.b.z * rc.x;
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
// The factor of a joint's freedom with that inertia: with its floors, drives and springs.
PC_FN Sym3 pc_joint_factor(PC_IO Slot n, Slot up, Sym3 inertia, Vec3 rc) {
  Real fast = pc_max(PC_LD(tree_rows, n, TREE_FAST), PC_LD(tree_rows, up, TREE_FAST));
  Sym3 freedom = pc_with_floor(PC_PASS n, inertia, rc, fast);
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
  return factor;
}
PC_FN Mat3 pc_rows_lower(Sym3 factor, Mat3 u) {
  return pc_mat3(pc_factor_lower(factor, u.a), pc_factor_lower(factor, u.b), pc_factor_lower(factor, u.c));
}
PC_FN Mat3 pc_rows_scaled(Sym3 factor, Mat3 y) {
  return pc_mat3(pc_factor_scaled(factor, y.a), pc_factor_scaled(factor, y.b), pc_factor_scaled(factor, y.c));
}
PC_FN Mat3 pc_rows_upper(Sym3 factor, Mat3 z) {
  return pc_mat3(pc_factor_upper(factor, z.a), pc_factor_upper(factor, z.b), pc_factor_upper(factor, z.c));
}
PC_FN Vec3 pc_dots(Vec3 z, Mat3 y) { return Vec3(pc_dot(z, y.a), pc_dot(z, y.b), pc_dot(z, y.c)); }
// Factors a node; what is left of its inertia, H - W U^T, its parent carries.
PC_FN Sym6 pc_factor_node(PC_IO Slot n, Slot up) {
  Sym6 h = pc_ldh_tree(PC_PASS n, TREE_H);
  Vec3 rc = pc_ld3_tree(PC_PASS n, TREE_RC);
  SixRows u = pc_joint_columns(h, rc);
  Sym3 factor = pc_joint_factor(PC_PASS n, up, pc_joint_inertia(u, rc), rc);
  // W = U E^T d E, and U D^-1 U^T of the same halves
  SixRows y;
  y.l = pc_rows_lower(factor, u.l);
  y.a = pc_rows_lower(factor, u.a);
  SixRows z;
  z.l = pc_rows_scaled(factor, y.l);
  z.a = pc_rows_scaled(factor, y.a);
#ifdef PC_SEEN
  pc_keep_seen(PC_PASS n);
#endif
  pc_sts_tree(PC_PASS n, TREE_D, factor);
  pc_stm_tree(PC_PASS n, TREE_W, pc_rows_upper(factor, z.l));
  pc_stm_tree(PC_PASS n, TREE_W + 9u, pc_rows_upper(factor, z.a));
  // H - W U^T, and what of it the parent carries
  Sym6 rest = pc_sym6(pc_sym_sub(h.l, pc_products(z.l.a, z.l.b, z.l.c, y.l.a, y.l.b, y.l.c)),
                      pc_mat3(pc_sub(h.c.a, pc_dots(z.l.a, y.a)), pc_sub(h.c.b, pc_dots(z.l.b, y.a)),
                              pc_sub(h.c.c, pc_dots(z.l.c, y.a))),
                      pc_sym_sub(h.a, pc_products(z.a.a, z.a.b, z.a.c, y.a.a, y.a.b, y.a.c)));
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
      Sym6 h =
          pc_sym6(pc_diagonal(PC_LD(tree_rows, n, TREE_MASS)), pc_mat3(z, z, z), pc_lds_tree(PC_PASS n, TREE_INERTIA));
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
