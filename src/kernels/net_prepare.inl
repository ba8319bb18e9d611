// Start of a sub-step of a net: its bodies, and its springs at the present poses.
#include "net_rows.inl"

PC_FN void pc_prepare_body(PC_IO Slot b, Index row) {
  Quad turned = PC_GATHER(pose, row, 1u);
  Quad inverse = PC_GATHER(mass, row, 1u);
  Quad linear = PC_GATHER(motion, row, 0u);
  PC_ST(net_rows, b, NET_MASS, linear.s);
  pc_sts_net(PC_PASS b, NET_INERTIA, pc_net_inertia(pc_quaternion(turned.v, turned.s), inverse.v, linear.s));
  PC_ST(net_rows, b, NET_MADE, PC_REAL(0.0));
  PC_ST(net_rows, b, NET_FRESH, PC_REAL(1.0));
  PC_ST(net_rows, b, NET_BOUND, PC_REAL(0.0));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Net n = pc_net(PC_PASS m);
  for (uint k = 0u; k < n.bodies; k++) {
    pc_prepare_body(PC_PASS pc_net_body(PC_PASS m, n, k), pc_net_row(PC_PASS m, n, k));
  }
  Index keeper = pc_net_row(PC_PASS m, n, n.bodies);
  PC_ST(net_rows, pc_net_body(PC_PASS m, n, 0u), NET_OWED, PC_GATHER(joint_impulse, keeper, 1u).v.x);
  pc_net_clear(PC_PASS m, n, NET_PUSH);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Slot a = pc_net_end(PC_PASS m, n, k, 0u);
    Slot b = pc_net_end(PC_PASS m, n, k, 1u);
    Index joint = pc_net_row(PC_PASS m, n, n.bodies + k);
    Index ia = pc_net_row(PC_PASS m, n, PC_UINT(nets, n.links + k * 2u));
    Index ib = pc_net_row(PC_PASS m, n, PC_UINT(nets, n.links + k * 2u + 1u));
    Quad place_a = PC_GATHER(pose, ia, 0u);
    Quad turn_a = PC_GATHER(pose, ia, 1u);
    Quad low_a = PC_GATHER(pose, ia, 2u);
    Quad place_b = PC_GATHER(pose, ib, 0u);
    Quad turn_b = PC_GATHER(pose, ib, 1u);
    Quad low_b = PC_GATHER(pose, ib, 2u);
    Vec3 ra = pc_rotate(pc_quaternion(turn_a.v, turn_a.s), PC_GATHER(joint_frame, joint, 0u).v);
    Vec3 rb = pc_rotate(pc_quaternion(turn_b.v, turn_b.s), PC_GATHER(joint_frame, joint, 2u).v);
    Vec3 apart = pc_add(pc_sub(place_b.v, place_a.v), pc_sub(low_b.v, low_a.v));
    Vec3 line = pc_add(apart, pc_sub(rb, ra));
    Real length = pc_length(line);
    Quad drive = PC_GATHER(joint_drive, joint, 1u);
    Quad power = PC_GATHER(joint_drive, joint, 2u);
    Vec3 axis = pc_scale(line, pc_inverse_or_zero(length));
    Sym3 block = pc_net_answer(PC_PASS a, b, ra, rb);
    Real answer = pc_max(pc_dot(axis, pc_sym_mul(block, axis)), PC_LD(net_rows, a, NET_MASS));
    // how far the sub-step is from resolving the spring
    precise Real pull = drive.v.z * PC_INFO(h) + drive.s;
    precise Real beyond = pull * PC_INFO(h) * answer;
    pc_st3_net(PC_PASS s, NET_LINE, line);
    PC_ST(net_rows, s, NET_LENGTH, length);
    pc_st3_net(PC_PASS s, NET_ARM_A, ra);
    pc_st3_net(PC_PASS s, NET_ARM_B, rb);
    PC_ST(net_rows, s, NET_REST, power.v.y);
    PC_ST(net_rows, s, NET_STIFFNESS, drive.v.z);
    PC_ST(net_rows, s, NET_DAMPING, drive.s);
    PC_ST(net_rows, s, NET_LATE, pc_unresolved(beyond));
    pc_st3_net(PC_PASS s, NET_START, ra);
    pc_st3_net(PC_PASS s, NET_START + 3u, rb);
    pc_st3_net(PC_PASS s, NET_AXIS, axis);
    pc_st3_net(PC_PASS s, NET_IMPULSE, pc_zero3());
  }
}
