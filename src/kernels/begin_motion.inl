// The stored velocity goes to where the first sub-step takes it up (stagger.inl).
PC_FN Mask pc_in_phase(Quad linear, Quad angular) { return pc_and(angular.s<PC_REAL(0.0), linear.s> PC_REAL(0.0)); }
PC_FN void pc_begin(PC_INOUT(BodyMotion) m, VelocityShift shift) {
  Mask dynamic_body = m.linear.s > PC_REAL(0.0);
  Mask in_phase = pc_in_phase(m.linear, m.angular);
  pc_add_shift(dynamic_body, shift.u, m.linear.v, m.linear_low.v);
  pc_add_shift(dynamic_body, shift.l, m.angular.v, m.angular_low.v);
  precise Real settling = m.angular_low.s - PC_REAL(1.0);
  m.angular_low.s = pc_max(settling, PC_REAL(0.0));
  m.angular.s = pc_select(in_phase, m.angular.s, PC_REAL(0.0));  // so far, that `synchronise` knows a first sub-step
}
#ifdef PC_DRAG
// of all sub-steps, which are of one length
PC_FN void pc_find_decays(PC_IO PC_INOUT(BodyForce) f) {
  Real h = PC_INFO(h);
  precise Real x = f.push.s * h;
  precise Real y = f.turn.s * h;
  f.slow = pc_decay(x);
  f.calm = f.slow;
  if (PC_ANY(pc_or(x < y, y < x))) f.calm = pc_decay(y);  // lint: allow (equal ones give the same)
}
#endif
