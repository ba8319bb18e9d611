// Exponential decay under linear drag; part of math.inl.

// e = exp(-x), phi = (1 - e) / x and phi2 = (1 - phi) / x for x >= 0 (clamped to 60): with them linear drag
// is exact under constant force. Taylor series of phi2 at y = x / 64, then six doublings:
//   phi(2y) = phi (1 - y phi / 2),  phi2(2y) = (phi2 + phi^2 / 2) / 2,  e(2y) = e(y)^2.
// Below x = 1, e = 1 - x phi rounds once instead of doubling its error six times. loss = 1 - e without
// cancellation: a velocity that is changed by its loss keeps the digits that multiplying by e would drop.
struct Decay {
  Real e;
  Real loss;
  Real phi;
  Real phi2;
};
// Without drag.
PC_FN Decay pc_no_decay() {
  Decay none;
  none.e = PC_REAL(1.0);
  none.loss = PC_REAL(0.0);
  none.phi = PC_REAL(1.0);
  none.phi2 = PC_REAL(0.5);
  return none;
}
// (1 / 2 - phi2) / y by its Taylor series, for y < 1.
PC_FN Real pc_decay_series(Real y) {
  precise Real r = (((((((((((PC_REAL(7.6471637318198164759e-13) * y - PC_REAL(1.1470745597729724714e-11)) * y +
                             PC_REAL(1.6059043836821614599e-10)) *
                                y -
                            PC_REAL(2.0876756987868098979e-9)) *
                               y +
                           PC_REAL(2.5052108385441718775e-8)) *
                              y -
                          PC_REAL(2.7557319223985890653e-7)) *
                             y +
                         PC_REAL(2.7557319223985890653e-6)) *
                            y -
                        PC_REAL(2.4801587301587301587e-5)) *
                           y +
                       PC_REAL(1.9841269841269841270e-4)) *
                          y -
                      PC_REAL(1.3888888888888888889e-3)) *
                         y +
                     PC_REAL(8.3333333333333333333e-3)) *
                        y -
                    PC_REAL(4.1666666666666666667e-2)) *
                       y +
                   PC_REAL(1.6666666666666666667e-1);
  return r;
}
// Beyond 60, e is no more than it is there; phi and phi2 go on falling.
PC_FN Decay pc_decay_far(Decay d, Real x, Mask beyond) {
  Real far_phi = pc_div(d.loss, x);
  precise Real rest = PC_REAL(1.0) - far_phi;
  Decay r = d;
  r.phi = pc_select(beyond, far_phi, d.phi);
  r.phi2 = pc_select(beyond, pc_div(rest, x), d.phi2);
  return r;
}
PC_FN Decay pc_decay(Real drag_times_h) {
  if (!PC_ANY(pc_nonzero(drag_times_h))) return pc_no_decay();  // lint: allow (what the rest makes of none)
  Real x = pc_min(drag_times_h, PC_REAL(60.0));
  precise Real y0 = x * PC_REAL(0.015625);
  Real p2 = pc_decay_series(y0);
  precise Real q2 = PC_REAL(0.5) - y0 * p2;
  precise Real q1 = PC_REAL(1.0) - y0 * q2;
  precise Real q0 = PC_REAL(1.0) - y0 * q1;
  Real y = y0;
  Real e = q0;
  Real phi = q1;
  Real phi2 = q2;
  for (uint k = 0u; k < 6u; k++) {
    precise Real n2 = (phi2 + phi * phi * PC_REAL(0.5)) * PC_REAL(0.5);
    precise Real n1 = phi * (PC_REAL(1.0) - y * phi * PC_REAL(0.5));
    precise Real n0 = e * e;
    precise Real twice = y + y;
    phi2 = n2;
    phi = n1;
    e = n0;
    y = twice;
  }
  precise Real loss = x * phi;
  precise Real gentle = PC_REAL(1.0) - loss;
  Decay d;
  d.e = pc_select(x < PC_REAL(1.0), gentle, e);
  d.loss = loss;
  d.phi = phi;
  d.phi2 = phi2;
  Mask beyond = drag_times_h > x;
  if (PC_ANY(beyond)) {  // lint: allow (other lanes keep what they have)
    d = pc_decay_far(d, pc_max(drag_times_h, x), beyond);
  }
  return d;
}
