// Conjugate gradients for a Newton step of a net: (1 + h R A R) y = R^-1 (what the impulses lack), see net_solve.

// The image of the search directions; answers with their product with them.
PC_FN Real pc_net_image(PC_IO Slot m, Net n) {
  Real h = PC_INFO(h);
  pc_net_clear(PC_PASS m, n, NET_SUM);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 impulse = pc_net_root(PC_PASS s, pc_ld3_net(PC_PASS s, NET_WAY));
    Vec3 ra = pc_ld3_net(PC_PASS s, NET_AIM);
    pc_net_add(PC_PASS pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u), NET_SUM, ra,
               pc_ld3_net(PC_PASS s, NET_AIM + 3u), impulse);
  }
  pc_net_rates(PC_PASS m, n, NET_SUM);
  Real product = PC_REAL(0.0);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 ra = pc_ld3_net(PC_PASS s, NET_AIM);
    Vec3 rb = pc_ld3_net(PC_PASS s, NET_AIM + 3u);
    Vec3 rate = pc_net_rate(PC_PASS pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u), ra, rb);
    Vec3 way = pc_ld3_net(PC_PASS s, NET_WAY);
    Vec3 image = pc_madd(way, pc_net_root(PC_PASS s, rate), h);
    pc_st3_net(PC_PASS s, NET_IMAGE, image);
    precise Real sum = product + pc_dot(way, image);
    product = sum;
  }
  return product;
}
// Goes on along the search directions by `step`, of the old ones keeps `kept`; answers with the new residual's square.
PC_FN Real pc_net_square(PC_IO Slot m, Net n, Real step) {
  Real square = PC_REAL(0.0);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 lack = pc_net_further(pc_ld3_net(PC_PASS s, NET_LACK), pc_ld3_net(PC_PASS s, NET_IMAGE), -step);
    pc_st3_net(PC_PASS s, NET_FOUND, pc_net_further(pc_ld3_net(PC_PASS s, NET_FOUND), pc_ld3_net(PC_PASS s, NET_WAY), step));
    pc_st3_net(PC_PASS s, NET_LACK, lack);
    precise Real sum = square + pc_dot(lack, pc_sym_mul(pc_lds_net(PC_PASS s, NET_BLOCK), lack));
    square = sum;
  }
  return square;
}
PC_FN void pc_net_turn(PC_IO Slot m, Net n, Real kept) {
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 down = pc_sym_mul(pc_lds_net(PC_PASS s, NET_BLOCK), pc_ld3_net(PC_PASS s, NET_LACK));
    pc_st3_net(PC_PASS s, NET_WAY, pc_madd(down, pc_ld3_net(PC_PASS s, NET_WAY), kept));
  }
}
// Finds a step, where `wants`.
PC_FN void pc_net_search(PC_IO Slot m, Net n, Mask wants) {
  Real zero = PC_REAL(0.0);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_st3_net(PC_PASS s, NET_IMAGE, pc_zero3());
    pc_st3_net(PC_PASS s, NET_WAY, pc_zero3());
    pc_st3_net(PC_PASS s, NET_FOUND, pc_select3(wants, pc_zero3(), pc_ld3_net(PC_PASS s, NET_FOUND)));
  }
  Real square = pc_net_square(PC_PASS m, n, zero);
  precise Real enough = square * (PC_INFO(rounding) * PC_INFO(rounding));
  Real kept = zero;
  Mask goes = wants;
  for (uint i = 0u; i < PC_COUNT(rounds); i++) {
    goes = pc_and(goes, pc_and(square > enough, square > PC_TINY));
    if (!PC_ANY(goes)) break;  // lint: allow (steps of those that are done are zero)
    pc_net_turn(PC_PASS m, n, kept);
    Real product = pc_net_image(PC_PASS m, n);
    Real step = pc_select(pc_and(goes, product > PC_TINY), pc_div(square, pc_max(product, PC_TINY)), zero);
    Real next = pc_net_square(PC_PASS m, n, step);
    kept = pc_select(goes, pc_div(next, pc_max(square, PC_TINY)), zero);
    square = next;
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 found = pc_ld3_net(PC_PASS s, NET_FOUND);
    Vec3 step = pc_add(pc_net_root(PC_PASS s, found), pc_ld3_net(PC_PASS s, NET_TURNED));
    pc_st3_net(PC_PASS s, NET_FOUND, pc_select3(wants, step, found));
  }
}
