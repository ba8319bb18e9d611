// A net: bodies that springs between points join, and none of which a pin holds. One lane solves a whole net, so sums
// over its springs need no order among lanes. Slots of a block: first its bodies, then its springs.
const uint NET_VELOCITY = 0u;  // of a body, before the solve; velocity 3, inverse mass
const uint NET_MASS = 3u;
const uint NET_MOMENTUM = 4u;  // angular, before the solve
const uint NET_INERTIA = 8u;   // inverse, 0 where nothing turns the body: xx xy xz yy yz zz
const uint NET_PUSH = 14u;     // impulse and angular impulse of the springs, of their first halves
const uint NET_SUM = 20u;      // the same of a search direction
const uint NET_RATE = 26u;     // velocities that it makes
const uint NET_STEP = 32u;     // way of the centre in the sub-step, and its turn
const uint NET_TURN = 35u;
const uint NET_SPIN = 39u;    // angular velocity before the solve
const uint NET_PUSHED = 42u;  // NET_PUSH before the solve
const uint NET_MADE = 48u;    // what the first halves did to its energy
const uint NET_FRESH = 54u;   // of the first body: 1 before the sub-step's first solve
const uint NET_OWED = 56u;    // of the first body: energy that was made and not paid yet (net_settle)
const uint NET_BOUND = 55u;   // and the share of the rigid motion in what net_bound made of what was solved
const uint NET_FIRST = 69u;   // NET_VELOCITY and NET_SPIN of the sub-step's first solve
const uint NET_FIRST_SPIN = 49u;
const uint NET_RIGID = 57u;  // impulse and angular impulse of the rigid motion, and of what was solved (net_bound)
const uint NET_SOLVED = 63u;
const uint NET_AFTER = 72u;  // and of what the rigid motion gives once the bodies have moved
const uint NET_LEVER = 78u;  // of the first body: what all of that changes the angular momentum by
// of a spring
const uint NET_LINE = 0u;  // from its point of a to that of b, where the sub-step began
const uint NET_LENGTH = 3u;
const uint NET_ARM_A = 4u;  // arms at which the first half acts: midway between those of before and after
const uint NET_REST = 7u;
const uint NET_ARM_B = 8u;
const uint NET_STIFFNESS = 11u;
const uint NET_AXIS = 12u;
const uint NET_ALONG = 15u;  // roots of the impulse per length along the axis and across it
const uint NET_ACROSS = 16u;
const uint NET_LATE = 17u;  // share of the damping by the implicit Euler method, see net_solve
const uint NET_DAMPING = 19u;
const uint NET_IMPULSE = 20u;  // its first half, on b
const uint NET_BLOCK = 24u;    // what prepares the search: inverse of its own 3 x 3 block
const uint NET_LACK = 30u;     // residual, search direction, its image, solution
const uint NET_WAY = 33u;
const uint NET_IMAGE = 36u;
const uint NET_FOUND = 39u;
const uint NET_NOW = 42u;  // its line after the bodies have moved, and its second half
const uint NET_SECOND = 45u;

const uint NET_TURNED = 48u;  // what the impulse's turn into a new line adds to it
const uint NET_LEVEL = 51u;   // its part in what the solve lowers (Merit)
const uint NET_OPEN = 52u;
const uint NET_GIVEN = 53u;
const uint NET_THEN = 18u;   // its length after the sub-step, foreseen
const uint NET_AIM = 54u;    // arms midway of the last step that was taken, of a and b
const uint NET_MID = 60u;    // and of the one that is looked at
const uint NET_START = 66u;  // arms where the sub-step began

struct Net {
  uint first;
  uint bodies;
  uint springs;
  uint links;
  uint rows;
};
PC_FN Net pc_net(PC_IO Slot m) {
  uint block = PC_BLOCK(m);
  uint at = block * 4u;
  Net n;
  n.first = PC_UINT(nets, at);
  n.bodies = PC_UINT(nets, at + 1u);
  n.springs = PC_UINT(nets, at + 2u);
  n.links = PC_UINT(nets, at + 3u);
  n.rows = n.links + n.springs * 2u;
  return n;
}
PC_FN Slot pc_net_body(PC_IO Slot m, Net n, uint k) { return PC_NODE(m, n.first + k); }
PC_FN Slot pc_net_spring(PC_IO Slot m, Net n, uint k) { return PC_NODE(m, n.first + n.bodies + k); }
PC_FN Slot pc_net_end(PC_IO Slot m, Net n, uint k, uint side) {
  uint link = n.links + k * 2u + side;
  uint body = PC_UINT(nets, link);
  return PC_NODE(m, n.first + body);
}
PC_FN Index pc_net_row(PC_IO Slot m, Net n, uint k) {
  uint at = n.rows + k * PC_W;
  return PC_EACH(nets, m, at);
}

PC_FN Vec3 pc_ld3_net(PC_IO Slot s, uint f) {
  return Vec3(PC_LD(net_rows, s, f), PC_LD(net_rows, s, f + 1u), PC_LD(net_rows, s, f + 2u));
}
PC_FN void pc_st3_net(PC_IO Slot s, uint f, Vec3 v) {
  PC_ST(net_rows, s, f, v.x);
  PC_ST(net_rows, s, f + 1u, v.y);
  PC_ST(net_rows, s, f + 2u, v.z);
}
PC_FN Sym3 pc_lds_net(PC_IO Slot s, uint f) {
  return pc_sym3(PC_LD(net_rows, s, f), PC_LD(net_rows, s, f + 1u), PC_LD(net_rows, s, f + 2u),
                 PC_LD(net_rows, s, f + 3u), PC_LD(net_rows, s, f + 4u), PC_LD(net_rows, s, f + 5u));
}
PC_FN void pc_sts_net(PC_IO Slot s, uint f, Sym3 k) {
  PC_ST(net_rows, s, f, k.xx);
  PC_ST(net_rows, s, f + 1u, k.xy);
  PC_ST(net_rows, s, f + 2u, k.xz);
  PC_ST(net_rows, s, f + 3u, k.yy);
  PC_ST(net_rows, s, f + 4u, k.yz);
  PC_ST(net_rows, s, f + 5u, k.zz);
}
// The inverse inertia of what impulses turn: a body that moves, and about which it is not said that it keeps its
// orientation.
PC_FN Sym3 pc_net_inertia(Quaternion q, Vec3 inverse, Real inverse_mass) {
  Real response = pc_select(inverse_mass > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  return pc_world_inertia(q, pc_scale(inverse, response));
}
// How two bodies' points answer an impulse between them: a 3 x 3 block.
PC_FN Sym3 pc_net_answer(PC_IO Slot a, Slot b, Vec3 ra, Vec3 rb) {
  precise Real both = PC_LD(net_rows, a, NET_MASS) + PC_LD(net_rows, b, NET_MASS);
  Sym3 ia = pc_lds_net(PC_PASS a, NET_INERTIA);
  Sym3 ib = pc_lds_net(PC_PASS b, NET_INERTIA);
  Vec3 x = Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0));
  Vec3 y = Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  Vec3 z = Vec3(PC_REAL(0.0), PC_REAL(0.0), PC_REAL(1.0));
  Vec3 ax = pc_cross(ra, x);
  Vec3 ay = pc_cross(ra, y);
  Vec3 az = pc_cross(ra, z);
  Vec3 bx = pc_cross(rb, x);
  Vec3 by = pc_cross(rb, y);
  Vec3 bz = pc_cross(rb, z);
  Vec3 iax = pc_sym_mul(ia, ax);
  Vec3 iay = pc_sym_mul(ia, ay);
  Vec3 iaz = pc_sym_mul(ia, az);
  Vec3 ibx = pc_sym_mul(ib, bx);
  Vec3 iby = pc_sym_mul(ib, by);
  Vec3 ibz = pc_sym_mul(ib, bz);
  precise Real xx = both + pc_dot(ax, iax) + pc_dot(bx, ibx);
  precise Real xy = pc_dot(ax, iay) + pc_dot(bx, iby);
  precise Real xz = pc_dot(ax, iaz) + pc_dot(bx, ibz);
  precise Real yy = both + pc_dot(ay, iay) + pc_dot(by, iby);
  precise Real yz = pc_dot(ay, iaz) + pc_dot(by, ibz);
  precise Real zz = both + pc_dot(az, iaz) + pc_dot(bz, ibz);
  return pc_sym3(xx, xy, xz, yy, yz, zz);
}
// Adds an impulse on b, and its opposite on a, to sums of their bodies.
PC_FN void pc_net_add(PC_IO Slot a, Slot b, uint sums, Vec3 ra, Vec3 rb, Vec3 impulse) {
  pc_st3_net(PC_PASS a, sums, pc_sub(pc_ld3_net(PC_PASS a, sums), impulse));
  pc_st3_net(PC_PASS a, sums + 3u, pc_sub(pc_ld3_net(PC_PASS a, sums + 3u), pc_cross(ra, impulse)));
  pc_st3_net(PC_PASS b, sums, pc_add(pc_ld3_net(PC_PASS b, sums), impulse));
  pc_st3_net(PC_PASS b, sums + 3u, pc_add(pc_ld3_net(PC_PASS b, sums + 3u), pc_cross(rb, impulse)));
}
// So much further along a way, and not at all where the share is zero: the way of a net that is done may be no number.
PC_FN Vec3 pc_net_further(Vec3 from, Vec3 way, Real share) {
  return pc_select3(pc_nonzero(share), pc_madd(from, way, share), from);
}
PC_FN void pc_net_clear(PC_IO Slot m, Net n, uint sums) {
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    pc_st3_net(PC_PASS b, sums, pc_zero3());
    pc_st3_net(PC_PASS b, sums + 3u, pc_zero3());
  }
}
// What rounding leaves of the momentum of pushes that have no sum goes to all bodies by their mass, unless something
// holds the net: impulses of stiff springs are large beside what they leave, and a net that moves as one would round
// alike in each sub-step.
PC_FN void pc_net_even(PC_IO Slot m, Net n, Mask these) {
  Real zero = PC_REAL(0.0);
  Real mass = zero;
  Mask even = these;
  Vec3 sum = pc_zero3();
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Real heavy = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS));
    precise Real more = mass + heavy;
    mass = more;
    even = pc_and(even, heavy > zero);
    sum = pc_add(sum, pc_ld3_net(PC_PASS b, NET_PUSH));
  }
  Real light = pc_inverse_or_zero(mass);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    precise Real share = pc_inverse_or_zero(PC_LD(net_rows, b, NET_MASS)) * light;
    Vec3 push = pc_ld3_net(PC_PASS b, NET_PUSH);
    pc_st3_net(PC_PASS b, NET_PUSH, pc_select3(even, pc_madd(push, sum, -share), push));
  }
}
// What holds a weight does no work: of an impulse that comes before the bodies move half of what gravity gives in the
// sub-step is in the velocities that it met. Between bodies that all fall that cancels; here is what it makes with
// those that do not.
PC_FN Real pc_net_held(PC_IO Slot m, Net n) {
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 push = pc_zero3();
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Real falls_a = pc_select(PC_LD(net_rows, pc_net_end(PC_PASS m, n, k, 0u), NET_MASS) > PC_REAL(0.0), PC_REAL(1.0),
                             PC_REAL(0.0));
    Real falls_b = pc_select(PC_LD(net_rows, pc_net_end(PC_PASS m, n, k, 1u), NET_MASS) > PC_REAL(0.0), PC_REAL(1.0),
                             PC_REAL(0.0));
    precise Real share = (falls_a - falls_b) * PC_LD(net_rows, s, NET_LATE);
    push = pc_madd(push, pc_ld3_net(PC_PASS s, NET_IMPULSE), share);
  }
  Real rigid = PC_LD(net_rows, pc_net_body(PC_PASS m, n, 0u), NET_BOUND);
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Real share = pc_select(PC_LD(net_rows, b, NET_MASS) > PC_REAL(0.0), PC_REAL(0.0), rigid);
    push = pc_net_further(push, pc_ld3_net(PC_PASS b, NET_RIGID), share);
  }
  precise Real work = pc_dot(push, gravity) * PC_INFO(h) * PC_REAL(0.5);
  return work;
}
// The velocities that sums of impulses make.
PC_FN void pc_net_rates(PC_IO Slot m, Net n, uint sums) {
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    pc_st3_net(PC_PASS b, NET_RATE, pc_scale(pc_ld3_net(PC_PASS b, sums), PC_LD(net_rows, b, NET_MASS)));
    Vec3 turned = pc_sym_mul(pc_lds_net(PC_PASS b, NET_INERTIA), pc_ld3_net(PC_PASS b, sums + 3u));
    pc_st3_net(PC_PASS b, NET_RATE + 3u, turned);
  }
}
// The same of the bodies as they are: with what they had before the solve.
PC_FN void pc_net_velocities(PC_IO Slot m, Net n) {
  for (uint k = 0u; k < n.bodies; k++) {
    Slot b = pc_net_body(PC_PASS m, n, k);
    Vec3 push = pc_ld3_net(PC_PASS b, NET_PUSH);
    Vec3 v = pc_madd(pc_ld3_net(PC_PASS b, NET_VELOCITY), push, PC_LD(net_rows, b, NET_MASS));
    Vec3 turned = pc_sym_mul(pc_lds_net(PC_PASS b, NET_INERTIA), pc_ld3_net(PC_PASS b, NET_PUSH + 3u));
    pc_st3_net(PC_PASS b, NET_RATE, v);
    pc_st3_net(PC_PASS b, NET_RATE + 3u, pc_add(pc_ld3_net(PC_PASS b, NET_SPIN), turned));
  }
}
// How fast the point of b leaves that of a.
PC_FN Vec3 pc_net_rate(PC_IO Slot a, Slot b, Vec3 ra, Vec3 rb) {
  Vec3 va = pc_add(pc_ld3_net(PC_PASS a, NET_RATE), pc_cross(pc_ld3_net(PC_PASS a, NET_RATE + 3u), ra));
  Vec3 vb = pc_add(pc_ld3_net(PC_PASS b, NET_RATE), pc_cross(pc_ld3_net(PC_PASS b, NET_RATE + 3u), rb));
  return pc_sub(vb, va);
}
// (a net that is not asked keeps what it has, to the bit, where nets beside it are)
PC_FN void pc_net_keep(PC_IO Slot b, uint f, Mask these, Vec3 v) {
  pc_st3_net(PC_PASS b, f, pc_select3(these, v, pc_ld3_net(PC_PASS b, f)));
}
