// What the angle rows of single joints and of trees share: the nearer of two limits,
// and the speed that is asked of a row.

// `sign`: +1 at the lower limit, -1 at the upper one.
struct NearerLimit {
  Real slack;
  Real sign;
  Mask locked;
};
PC_FN NearerLimit pc_nearer_limit(PC_IO Real angle, Real lower, Real upper, Mask exists) {
  precise Real above = angle - lower;
  precise Real below = upper - angle;
  precise Real interval = upper - lower;
  Mask at_lower = above < below;
  NearerLimit r;
  r.locked = pc_and(exists, interval < PC_INFO(locked_interval));
  r.sign = pc_select(pc_or(at_lower, r.locked), PC_REAL(1.0), PC_REAL(-1.0));
  r.slack = pc_select(r.locked, above, pc_select(at_lower, above, below));
  return r;
}
// An angle beyond its limit is undone as a soft constraint; an open row stops what would close its slack within the
// sub-step.
PC_FN Real pc_within_push_speed(PC_IO Real rate) {
  return pc_clamp(rate, -PC_INFO(joint_push_speed), PC_INFO(joint_push_speed));
}
PC_FN Real pc_soft_bias(PC_IO Real slack) {
  precise Real rate = slack * PC_INFO(soft_rate);
  return pc_within_push_speed(PC_PASS rate);
}
PC_FN Real pc_angle_bias(PC_IO Real slack, Mask open) {
  precise Real gap_rate = slack * PC_INFO(inverse_h);
  return pc_select(open, gap_rate, pc_soft_bias(PC_PASS slack));
}
// Of how far an angle is beyond its limit in a tree, what the velocity undoes. What is beyond that is a push, which
// moves poses alone (tree_again.inl): by velocities a limb that the host turned far out of its limits would leave them
// with up to joint_push_speed. Of a locked angle that is all, since it does not give.
PC_FN Real pc_little_beyond(PC_IO Real slack, Real kind) {
  return pc_select(kind > PC_REAL(1.0), PC_REAL(0.0), pc_clamp(slack, -PC_INFO(limit_give), PC_INFO(limit_give)));
}
