// Conjugate directions for a Newton step of a net: (1 + h R A R) y = R^-1 (what the impulses lack), see net_solve.
//
// Along each direction the quadratic form of these is lowered; or, `bent`, that of what the solve lowers (Merit), which
// is the same with R A R before it: it takes more directions, but leads down however few there were. Directions are
// conjugate to the one before, in that form.

// The preconditioned residual.
PC_FN Vec3 pc_net_down(PC_IO Slot s) {
  return pc_sym_mul(pc_lds_net(PC_PASS s, NET_BLOCK), pc_ld3_net(PC_PASS s, NET_LACK));
}
// R A R of it, at NET_SECOND.
PC_FN void pc_net_answer_down(PC_IO Slot m, Net n) {
  pc_net_clear(PC_PASS m, n, NET_SUM);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 impulse = pc_net_root(PC_PASS s, pc_net_down(PC_PASS s));
    pc_net_add(PC_PASS pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u), NET_SUM,
               pc_ld3_net(PC_PASS s, NET_AIM), pc_ld3_net(PC_PASS s, NET_AIM + 3u), impulse);
  }
  pc_net_rates(PC_PASS m, n, NET_SUM);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 rate = pc_net_rate(PC_PASS pc_net_end(PC_PASS m, n, k, 0u), pc_net_end(PC_PASS m, n, k, 1u),
                            pc_ld3_net(PC_PASS s, NET_AIM), pc_ld3_net(PC_PASS s, NET_AIM + 3u));
    pc_st3_net(PC_PASS s, NET_SECOND, pc_net_root(PC_PASS s, rate));
  }
}
// The form's product of it with the last direction.
PC_FN Real pc_net_product(PC_IO Slot m, Net n) {
  Real product = PC_REAL(0.0);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 image = pc_madd(pc_net_down(PC_PASS s), pc_ld3_net(PC_PASS s, NET_SECOND), PC_INFO(h));
    precise Real sum = product + pc_dot(pc_ld3_net(PC_PASS s, NET_NOW), image);
    product = sum;
  }
  return product;
}
// The next direction, with so much of the last one in it; answers with its slope and its curvature.
struct Bend {
  Real slope;
  Real curvature;
};
PC_FN Bend pc_net_turn(PC_IO Slot m, Net n, Real kept, Mask bent) {
  Bend all;
  all.slope = PC_REAL(0.0);
  all.curvature = PC_REAL(0.0);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 down = pc_net_down(PC_PASS s);
    Vec3 answer = pc_ld3_net(PC_PASS s, NET_SECOND);
    Vec3 image_down = pc_madd(down, answer, PC_INFO(h));
    Vec3 answers = pc_madd(pc_select3(bent, answer, down), pc_ld3_net(PC_PASS s, NET_NOW), kept);
    Vec3 image = pc_madd(image_down, pc_ld3_net(PC_PASS s, NET_IMAGE), kept);
    pc_st3_net(PC_PASS s, NET_WAY, pc_madd(down, pc_ld3_net(PC_PASS s, NET_WAY), kept));
    pc_st3_net(PC_PASS s, NET_NOW, answers);
    pc_st3_net(PC_PASS s, NET_IMAGE, image);
    precise Real slope = all.slope + pc_dot(answers, pc_ld3_net(PC_PASS s, NET_LACK));
    precise Real curvature = all.curvature + pc_dot(answers, image);
    all.slope = slope;
    all.curvature = curvature;
  }
  return all;
}
// Goes on along it.
PC_FN void pc_net_go(PC_IO Slot m, Net n, Real step) {
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_st3_net(PC_PASS s, NET_FOUND,
               pc_net_further(pc_ld3_net(PC_PASS s, NET_FOUND), pc_ld3_net(PC_PASS s, NET_WAY), step));
    pc_st3_net(PC_PASS s, NET_LACK,
               pc_net_further(pc_ld3_net(PC_PASS s, NET_LACK), pc_ld3_net(PC_PASS s, NET_IMAGE), -step));
  }
}
// Finds a step, where `wants`.
PC_FN void pc_net_search(PC_IO Slot m, Net n, Mask wants, Mask bent) {
  Real zero = PC_REAL(0.0);
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    pc_st3_net(PC_PASS s, NET_NOW, pc_zero3());
    pc_st3_net(PC_PASS s, NET_IMAGE, pc_zero3());
    pc_st3_net(PC_PASS s, NET_WAY, pc_zero3());
    pc_st3_net(PC_PASS s, NET_FOUND, pc_select3(wants, pc_zero3(), pc_ld3_net(PC_PASS s, NET_FOUND)));
  }
  Bend last;
  last.slope = zero;
  last.curvature = zero;
  Real enough = zero;
  Mask goes = wants;
  for (uint i = 0u; i < PC_COUNT(rounds); i++) {
    pc_net_answer_down(PC_PASS m, n);
    Real product = pc_net_product(PC_PASS m, n);
    Real kept = pc_select(last.curvature > PC_TINY, pc_div(-product, pc_max(last.curvature, PC_TINY)), zero);
    last = pc_net_turn(PC_PASS m, n, kept, bent);
    goes = pc_and(goes, pc_and(last.slope > enough, last.curvature > PC_TINY));
    if (!PC_ANY(goes)) break;  // lint: allow (steps of those that are done are zero)
    precise Real least = last.slope * (PC_INFO(rounding) * PC_INFO(rounding));
    if (i == 0u) enough = least;
    pc_net_go(PC_PASS m, n, pc_select(goes, pc_div(last.slope, pc_max(last.curvature, PC_TINY)), zero));
  }
  for (uint k = 0u; k < n.springs; k++) {
    Slot s = pc_net_spring(PC_PASS m, n, k);
    Vec3 found = pc_ld3_net(PC_PASS s, NET_FOUND);
    Vec3 step = pc_add(pc_net_root(PC_PASS s, found), pc_ld3_net(PC_PASS s, NET_TURNED));
    pc_st3_net(PC_PASS s, NET_FOUND, pc_select3(wants, step, found));
  }
}
