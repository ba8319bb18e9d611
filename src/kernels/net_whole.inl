// A net as one rigid body: where its centre is, and how it answers.
// `light`: 1 / mass; `loose`: inverse inertia, in units of 1 / unit.
struct Whole {
  Vec3 centre;
  Real light;
  Sym3 loose;
  Sym3 tensor;
  Real unit;
};
PC_FN Vec3 pc_net_place(PC_IO Slot m, Net n, uint k) {
  Index first = pc_net_row(PC_PASS m, n, 0u);
  Index row = pc_net_row(PC_PASS m, n, k);
  Vec3 high = pc_sub(PC_GATHER(pose, row, 0u).v, PC_GATHER(pose, first, 0u).v);
  return pc_add(high, pc_sub(PC_GATHER(pose, row, 2u).v, PC_GATHER(pose, first, 2u).v));
}
PC_FN Sym3 pc_net_moments(PC_IO Index row) {
  Quad turned = PC_GATHER(pose, row, 1u);
  Quad moments = PC_GATHER(mass, row, 0u);
  Real turns = pc_select(PC_GATHER(mass, row, 1u).v.x > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  return pc_world_inertia(pc_quaternion(turned.v, turned.s), pc_scale(moments.v, turns));
}
// `ahead`: 1 at the places that are foreseen for the end of the sub-step, 0 at those of now.
PC_FN Vec3 pc_net_place_then(PC_IO Slot m, Net n, uint k, Real ahead) {
  return pc_net_further(pc_net_place(PC_PASS m, n, k), pc_ld3_net(PC_PASS pc_net_body(PC_PASS m, n, k), NET_STEP),
                        ahead);
}
PC_FN Whole pc_net_whole(PC_IO Slot m, Net n, Real ahead) {
  Whole r;
  Real mass_all = PC_REAL(0.0);
  r.centre = pc_zero3();
  for (uint k = 0u; k < n.bodies; k++) {
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, pc_net_body(PC_PASS m, n, k), NET_MASS));
    r.centre = pc_madd(r.centre, pc_net_place_then(PC_PASS m, n, k, ahead), heavy);
    precise Real sum = mass_all + heavy;
    mass_all = sum;
  }
  r.light = pc_inverse_or_zero(mass_all);
  r.centre = pc_scale(r.centre, r.light);
  Sym3 all = pc_world_inertia(pc_quaternion(pc_zero3(), PC_REAL(1.0)), pc_zero3());
  for (uint k = 0u; k < n.bodies; k++) {
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, pc_net_body(PC_PASS m, n, k), NET_MASS));
    Real counts = pc_select(heavy > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
    Vec3 arm = pc_sub(pc_net_place_then(PC_PASS m, n, k, ahead), r.centre);
    Sym3 own = pc_net_moments(PC_PASS pc_net_row(PC_PASS m, n, k));
    precise Real square = pc_dot(arm, arm);
    precise Real xx = own.xx * counts + heavy * (square - arm.x * arm.x);
    precise Real xy = own.xy * counts - heavy * arm.x * arm.y;
    precise Real xz = own.xz * counts - heavy * arm.x * arm.z;
    precise Real yy = own.yy * counts + heavy * (square - arm.y * arm.y);
    precise Real yz = own.yz * counts - heavy * arm.y * arm.z;
    precise Real zz = own.zz * counts + heavy * (square - arm.z * arm.z);
    Sym3 more = pc_sym3(xx, xy, xz, yy, yz, zz);
    all = pc_sym_add(all, more);
  }
  // (in units of its largest, whose cube is a number in single precision too)
  precise Real trace = all.xx + all.yy + all.zz;
  r.unit = pc_inverse_or_zero(trace);
  Sym3 scaled;
  Vec3 diagonal = pc_scale(Vec3(all.xx, all.yy, all.zz), r.unit);
  Vec3 beside = pc_scale(Vec3(all.xy, all.xz, all.yz), r.unit);
  scaled.xx = diagonal.x;
  scaled.yy = diagonal.y;
  scaled.zz = diagonal.z;
  scaled.xy = beside.x;
  scaled.xz = beside.y;
  scaled.yz = beside.z;
  r.loose = pc_sym_inverse(scaled);
  r.tensor = scaled;
  return r;
}
// The spin that an angular momentum gives it. (Once more for what the inverse has lost: a net may be a line.)
PC_FN Vec3 pc_net_spin(Whole all, Vec3 l) {
  Vec3 momentum = pc_scale(l, all.unit);
  Vec3 spin = pc_sym_mul(all.loose, momentum);
  return pc_add(spin, pc_sym_mul(all.loose, pc_sub(momentum, pc_sym_mul(all.tensor, spin))));
}
// What the rigid motion gives once the bodies have moved, by its share in what the net does, as sums to add to. What of
// its angular momentum it lacks where the bodies have gone elsewhere the net is given as one body.
PC_FN void pc_net_begin_after(PC_IO Slot m, Net n, uint sums, Real ahead) {
  Slot keeper = pc_net_body(PC_PASS m, n, 0u);
  Real rigid = PC_LD(net_rows, keeper, NET_BOUND);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    pc_st3_net(PC_PASS b, sums, pc_net_further(pc_zero3(), pc_ld3_net(PC_PASS b, NET_AFTER), rigid));
    pc_st3_net(PC_PASS b, sums + 3u, pc_net_further(pc_zero3(), pc_ld3_net(PC_PASS b, NET_AFTER + 3u), rigid));
  }
  Mask turns = rigid > PC_REAL(0.0);
  if (!PC_ANY(turns)) return;  // lint: allow (zeros otherwise)
  Whole all = pc_net_whole(PC_PASS m, n, ahead);
  Vec3 lacks = pc_net_further(pc_zero3(), pc_ld3_net(PC_PASS keeper, NET_LEVER), rigid);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Vec3 arm = pc_sub(pc_net_place_then(PC_PASS m, n, k, ahead), all.centre);
    Vec3 had = pc_add(pc_cross(arm, pc_ld3_net(PC_PASS b, sums)), pc_ld3_net(PC_PASS b, sums + 3u));
    lacks = pc_sub(lacks, had);
  }
  Vec3 spin = pc_select3(turns, pc_net_spin(all, lacks), pc_zero3());
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    Vec3 arm = pc_sub(pc_net_place_then(PC_PASS m, n, k, ahead), all.centre);
    Vec3 turn = pc_sym_mul(pc_net_moments(PC_PASS pc_net_row(PC_PASS m, n, k)), spin);
    pc_st3_net(PC_PASS b, sums, pc_madd(pc_ld3_net(PC_PASS b, sums), pc_cross(spin, arm), heavy));
    pc_st3_net(PC_PASS b, sums + 3u,
               pc_add(pc_ld3_net(PC_PASS b, sums + 3u), pc_select3(heavy > PC_REAL(0.0), turn, pc_zero3())));
  }
}
