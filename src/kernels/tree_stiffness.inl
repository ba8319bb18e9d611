// Inertia of a tree's bodies with the stiffness of their pins in it.
//
// Geometric stiffness: a pin's impulse F turns with the body, so while the body turns by h dw the torque changes by
// (h dw x r) x F. Half of that, from the last sub-step's F, may stand in the inertia: I + h / 2 sum of (r . F) 1 - r
// F^T (symmetric part, shifted to be positive). Without it stiff chains under heavy loads diverge (docs/joints.md).
PC_FN Sym3 pc_geometric(Sym3 k, Vec3 r, Vec3 f) {
  Real d = pc_dot(r, f);
  Real s = PC_REAL(-0.5);
  precise Real xx = k.xx + (d - r.x * f.x);
  precise Real yy = k.yy + (d - r.y * f.y);
  precise Real zz = k.zz + (d - r.z * f.z);
  precise Real xy = k.xy + (r.x * f.y + r.y * f.x) * s;
  precise Real xz = k.xz + (r.x * f.z + r.z * f.x) * s;
  precise Real yz = k.yz + (r.y * f.z + r.z * f.y) * s;
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
// Of a body's inertia I and the stiffness k of its pins: x = h^2 k / 4 I (k is an impulse: of the sub-step) is the
// limit of stability at 1. `fast` = x / (1 + x); the inertia gets fast h / 2 (k - low 1), low at most the smallest
// eigenvalue of k: a term of fourth order where the sub-step resolves the motion, stable at any x.
struct Stiffened {
  Sym3 inertia;
  Real fast;
};
#define PC_ROOT_THIRD PC_REAL(0.577350269189625765)
#define PC_ROOT_THIRD_PAST_HALF PC_REAL(0.0773502691896257645)
// At most the smallest eigenvalue of k and zero, from invariants, so that it does not depend on how the world is
// turned. With the mean m of the eigenvalues, s = sqrt(|k - m|^2 / 6) and r = det(k - m) / (2 s^3) it is m - 2 s
// cos(acos(-r) / 3). For that cosine stands 1/2 + sqrt(x / 3) + (1/2 - sqrt(1/3)) x, x = (1 - r) / 2, which is exact
// where two eigenvalues are equal, as those of one pin that pulls or pushes along its arm are, and else too large by
// less than 0.4 %.
PC_FN Real pc_lowest_or_zero(Sym3 k) {
  precise Real mean = (k.xx + k.yy + k.zz) * PC_THIRD;
  precise Real x = k.xx - mean;
  precise Real y = k.yy - mean;
  precise Real z = k.zz - mean;
  // (squares of what is heavy would overflow)
  Real largest =
      pc_max(pc_max(pc_abs(x), pc_max(pc_abs(y), pc_abs(z))), pc_max(pc_abs(k.xy), pc_max(pc_abs(k.xz), pc_abs(k.yz))));
  Real unit = pc_inverse_or_zero(largest);
  precise Real a1 = x * unit;
  precise Real b1 = y * unit;
  precise Real c1 = z * unit;
  precise Real f1 = k.xy * unit;
  precise Real g1 = k.xz * unit;
  precise Real h1 = k.yz * unit;
  precise Real across = f1 * f1 + g1 * g1 + h1 * h1;
  precise Real square = (a1 * a1 + b1 * b1 + c1 * c1 + across + across) * PC_REAL(0.5) * PC_THIRD;
  Real root = pc_sqrt(square);
  precise Real size = root * largest;
  Real scale = pc_inverse_or_zero(root);
  precise Real a = a1 * scale;
  precise Real b = b1 * scale;
  precise Real c = c1 * scale;
  precise Real f = f1 * scale;
  precise Real g = g1 * scale;
  precise Real h = h1 * scale;
  precise Real det = a * (b * c - h * h) - f * (f * c - h * g) + g * (f * h - b * g);
  precise Real part = PC_REAL(0.5) - pc_quarter(det);
  Real of_all = pc_clamp(part, PC_REAL(0.0), PC_REAL(1.0));
  precise Real cosine = PC_REAL(0.5) + pc_sqrt(of_all) * PC_ROOT_THIRD - of_all * PC_ROOT_THIRD_PAST_HALF;
  precise Real low = mean - size * cosine * PC_REAL(2.0);
  return pc_min(PC_REAL(0.0), low);
}
PC_FN Stiffened pc_stiffened(PC_IO Sym3 i, Sym3 k) {
  Real low = pc_lowest_or_zero(k);
  precise Real stiff = (k.xx + k.yy + k.zz - (low + (low + low))) * PC_INFO(h);
  precise Real trace = i.xx + i.yy + i.zz;
  Real slow = pc_four_times(trace);
  precise Real all = stiff + slow;
  precise Real fast = stiff * pc_inverse_or_zero(all);
  precise Real weight = PC_INFO(h) * PC_REAL(0.5) * fast;
  precise Real xx = i.xx + (k.xx - low) * weight;
  precise Real xy = i.xy + k.xy * weight;
  precise Real xz = i.xz + k.xz * weight;
  precise Real yy = i.yy + (k.yy - low) * weight;
  precise Real yz = i.yz + k.yz * weight;
  precise Real zz = i.zz + (k.zz - low) * weight;
  Stiffened r;
  r.inertia = pc_sym3(xx, xy, xz, yy, yz, zz);
  r.fast = fast;
  return r;
}

// What a node's pin gives to the stiffness of its body, and to that of its parent.
PC_FN void pc_stiffen(PC_IO Slot n) {
  pc_sts_tree(
      PC_PASS n, TREE_H,
      pc_geometric(pc_lds_tree(PC_PASS n, TREE_H), pc_ld3_tree(PC_PASS n, TREE_RC), pc_ld3_tree(PC_PASS n, TREE_PIN)));
}
PC_FN void pc_stiffen_parent(PC_IO Slot n, Slot up) {
  pc_sts_tree(PC_PASS up, TREE_H,
              pc_geometric(pc_lds_tree(PC_PASS up, TREE_H), pc_ld3_tree(PC_PASS n, TREE_RP),
                           pc_negate(pc_ld3_tree(PC_PASS n, TREE_PIN))));
}
// TREE_INERTIA and TREE_FAST of all nodes, from TREE_BODY and the impulses at TREE_PIN.
PC_FN void pc_tree_stiffness(PC_IO Slot m, Tree t) {
  PC_NODES(k, 0u, t) pc_sts_tree(PC_PASS PC_NODE(m, t.first + k), TREE_H, pc_diagonal(PC_REAL(0.0)));
  PC_NODES(k, 1u, t) {
    pc_stiffen(PC_PASS PC_NODE(m, t.first + k));
    PC_THEN(PC_CHILDREN(k, t))
    pc_stiffen_parent(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
  }
  PC_MEET;
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Stiffened stiff = pc_stiffened(PC_PASS pc_lds_tree(PC_PASS n, TREE_BODY), pc_lds_tree(PC_PASS n, TREE_H));
    pc_sts_tree(PC_PASS n, TREE_INERTIA, stiff.inertia);
    PC_ST(tree_rows, n, TREE_FAST, stiff.fast);
  }
}
