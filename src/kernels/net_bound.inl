// What a net does in a sub-step that Newton's method did not solve: it makes no energy.

// The energy that the sub-step will have made with the impulses as they are, and what there is of it.
struct Energy { Real made; Real scale; };
PC_FN Real pc_net_stored(PC_IO Slot s, Real length) {
  precise Real longer = length - PC_LD(net_rows, s, NET_REST);
  precise Real stored = PC_LD(net_rows, s, NET_STIFFNESS) * longer * longer * PC_REAL(0.5);
  return stored;
}
PC_FN Energy pc_net_energy(PC_IO Slot m, Net n) {
  Energy e;
  e.made = PC_REAL(0.0);
  e.scale = PC_REAL(0.0);
  pc_net_clear(PC_PASS m, n, NET_SUM);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Real late = PC_LD(net_rows, s, NET_LATE);
    precise Real less = PC_REAL(1.0) - late;
    precise Real more = PC_REAL(1.0) + late;
    Vec3 second = pc_scale(pc_ld3_net(PC_PASS s, NET_IMPULSE), pc_div(less, more));
    Vec3 ra = pc_ld3_net(PC_PASS s, NET_ARM_A);
    Vec3 rb = pc_ld3_net(PC_PASS s, NET_ARM_B);
    pc_net_add(PC_PASS pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u), NET_SUM, ra, rb, second);
  }
  pc_net_velocities(PC_PASS m, n);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    pc_net_foresee(PC_PASS b, pc_net_row(PC_PASS m, n, k));
    Vec3 push = pc_ld3_net(PC_PASS b, NET_SUM);
    Vec3 turn = pc_ld3_net(PC_PASS b, NET_SUM + 3u);
    precise Real half_mass = PC_LD(net_rows, b, NET_MASS) * PC_REAL(0.5);
    Vec3 v = pc_madd(pc_ld3_net(PC_PASS b, NET_RATE), push, half_mass);
    Vec3 turned = pc_sym_mul(pc_lds_net(PC_PASS b, NET_INERTIA), turn);
    Vec3 w = pc_madd(pc_ld3_net(PC_PASS b, NET_RATE + 3u), turned, PC_REAL(0.5));
    precise Real second = pc_dot(push, v) + pc_dot(turn, w);
    precise Real made = e.made + PC_LD(net_rows, b, NET_MADE) + pc_net_count(PC_PASS b) + second;
    e.made = made;
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_net_look(PC_PASS s, pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u), PC_REAL(0.0));
    Real before = pc_net_stored(PC_PASS s, PC_LD(net_rows, s, NET_LENGTH));
    Real after = pc_net_stored(PC_PASS s, PC_LD(net_rows, s, NET_THEN));
    precise Real made = e.made + (after - before);
    precise Real scale = e.scale + before;
    e.made = made;
    e.scale = scale;
  }
  return e;
}

// The motion of the whole net as one rigid body with its momenta; or, where something holds it, that of what does.
struct Rigid { Vec3 v; Vec3 w; Vec3 centre; Real light; Mask held; };  // light: 1 / mass
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
PC_FN Rigid pc_net_rigid(PC_IO Slot m, Net n) {
  Rigid r;
  Real zero = PC_REAL(0.0);
  r.held = zero > PC_REAL(1.0);
  r.v = pc_zero3();
  r.w = pc_zero3();
  r.centre = pc_zero3();
  Vec3 held_v = pc_zero3();
  Vec3 held_w = pc_zero3();
  Vec3 held_at = pc_zero3();
  Real mass_all = zero;
  Vec3 p = pc_zero3();
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Mask stands = pc_select(PC_LD(net_rows, b, NET_MASS) > zero, zero, PC_REAL(1.0)) > PC_REAL(0.5);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    Vec3 place = pc_net_place(PC_PASS m, n, k);
    Vec3 told = pc_ld3_net(PC_PASS b, NET_VELOCITY);
    held_v = pc_select3(pc_and(stands, pc_dot(told, told) > pc_dot(held_v, held_v)), told, held_v);
    held_at = pc_select3(stands, place, held_at);
    r.held = pc_or(r.held, stands);
    p = pc_madd(p, pc_ld3_net(PC_PASS b, NET_VELOCITY), heavy);
    r.centre = pc_madd(r.centre, place, heavy);
    precise Real sum = mass_all + heavy;
    mass_all = sum;
  }
  r.light = pc_inverse_or_zero(mass_all);
  r.centre = pc_scale(r.centre, r.light);
  r.v = pc_scale(p, r.light);
  Vec3 l = pc_zero3();
  Sym3 all = pc_world_inertia(pc_quaternion(pc_zero3(), PC_REAL(1.0)), pc_zero3());
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    Real counts = pc_select(heavy > zero, PC_REAL(1.0), zero);
    Vec3 arm = pc_sub(pc_net_place(PC_PASS m, n, k), r.centre);
    Vec3 orbit = pc_cross(arm, pc_sub(pc_ld3_net(PC_PASS b, NET_VELOCITY), r.v));
    l = pc_madd(pc_madd(l, orbit, heavy), pc_ld3_net(PC_PASS b, NET_MOMENTUM), counts);
    Sym3 own = pc_net_moments(PC_PASS pc_net_row(PC_PASS m, n, k));
    precise Real square = pc_dot(arm, arm);
    precise Real xx = own.xx * counts + heavy * (square - arm.x * arm.x);
    precise Real xy = own.xy * counts - heavy * arm.x * arm.y;
    precise Real xz = own.xz * counts - heavy * arm.x * arm.z;
    precise Real yy = own.yy * counts + heavy * (square - arm.y * arm.y);
    precise Real yz = own.yz * counts - heavy * arm.y * arm.z;
    precise Real zz = own.zz * counts + heavy * (square - arm.z * arm.z);
    Sym3 more;
    more.xx = xx;
    more.xy = xy;
    more.xz = xz;
    more.yy = yy;
    more.yz = yz;
    more.zz = zz;
    all = pc_sym_add(all, more);
  }
  // (in units of its largest, whose cube is a number in single precision too)
  precise Real trace = all.xx + all.yy + all.zz;
  Real unit = pc_inverse_or_zero(trace);
  Sym3 scaled;
  Vec3 diagonal = pc_scale(Vec3(all.xx, all.yy, all.zz), unit);
  Vec3 beside = pc_scale(Vec3(all.xy, all.xz, all.yz), unit);
  scaled.xx = diagonal.x;
  scaled.yy = diagonal.y;
  scaled.zz = diagonal.z;
  scaled.xy = beside.x;
  scaled.xz = beside.y;
  scaled.yz = beside.z;
  r.w = pc_select3(r.held, held_w, pc_sym_mul(pc_sym_inverse(scaled), pc_scale(l, unit)));
  r.v = pc_select3(r.held, held_v, r.v);
  r.centre = pc_select3(r.held, held_at, r.centre);
  return r;
}
// The rigid motion in place of what was solved, where `brings`.
PC_FN void pc_net_stiffen(PC_IO Slot m, Net n, Rigid r, Mask brings) {
  Vec3 sum = pc_zero3();
  Real zero = PC_REAL(0.0);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Index row = pc_net_row(PC_PASS m, n, k);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    Vec3 arm = pc_sub(pc_net_place(PC_PASS m, n, k), r.centre);
    Vec3 v = pc_sub(pc_add(r.v, pc_cross(r.w, arm)), pc_ld3_net(PC_PASS b, NET_VELOCITY));
    Vec3 l = pc_sub(pc_sym_mul(pc_net_moments(PC_PASS row), r.w), pc_ld3_net(PC_PASS b, NET_MOMENTUM));
    Vec3 push = pc_scale(v, heavy);
    Mask here = pc_and(brings, heavy > zero);
    pc_net_keep(PC_PASS b, NET_PUSH, here, push);
    pc_net_keep(PC_PASS b, NET_PUSH + 3u, here, l);
    sum = pc_add(sum, pc_select3(here, push, pc_zero3()));
  }
  // what holds the net takes what its momentum lacks, the fastest of it by its velocity: others do no work. Where nothing
  // does all take what rounding has left, by their mass: the net may move so for many sub-steps, with the same rounding in each
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    Mask stands = pc_select(heavy > zero, zero, PC_REAL(1.0)) > PC_REAL(0.5);
    precise Real share = heavy * r.light;
    Vec3 rest = pc_madd(pc_ld3_net(PC_PASS b, NET_PUSH), sum, -pc_select(r.held, zero, share));
    pc_net_keep(PC_PASS b, NET_PUSH, brings, pc_select3(stands, pc_negate(sum), rest));
    pc_net_keep(PC_PASS b, NET_PUSH + 3u, pc_and(brings, stands), pc_zero3());
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_net_keep(PC_PASS s, NET_IMPULSE, brings, pc_zero3());
    PC_ST(net_rows, s, NET_LATE, pc_select(brings, PC_REAL(1.0), PC_LD(net_rows, s, NET_LATE)));
  }
}
// Where Newton's method did not come far enough, and the sub-step would make energy, the net moves as one rigid body.
PC_FN void pc_net_bound(PC_IO Slot m, Net n, Mask asked) {
  Energy e = pc_net_energy(PC_PASS m, n);
  Real motion = PC_REAL(0.0);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Vec3 v = pc_ld3_net(PC_PASS b, NET_VELOCITY);
    precise Real sum = motion + pc_dot(v, v) * pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS)) * PC_REAL(0.5);
    motion = sum;
  }
  precise Real most = (e.scale + motion) * PC_INFO(net_made);
  Mask makes = pc_and(asked, e.made > most);
  if (!PC_ANY(makes)) return;  // lint: allow (others keep what they have)
  Slot keeper = pc_net_body(PC_PASS m, n, 0u);
  PC_ST(net_rows, keeper, NET_BOUND, pc_select(makes, PC_REAL(1.0), PC_LD(net_rows, keeper, NET_BOUND)));
  pc_net_stiffen(PC_PASS m, n, pc_net_rigid(PC_PASS m, n), makes);
}
