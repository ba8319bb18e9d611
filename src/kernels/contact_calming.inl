// The share of an impulse (and couple) that takes most energy out: rate share + response share^2 / 2 is least there.
// Twice that share takes out nothing, more puts energy in.
PC_FN Real pc_calming_share(BodyState a, BodyState b, Arms arms, Vec3 impulse, Vec3 couple) {
  Vec3 ta = pc_add(couple, pc_cross(arms.a, impulse));
  Vec3 tb = pc_add(couple, pc_cross(arms.b, impulse));
  precise Real rate =
      pc_dot(impulse, pc_sub(b.v, a.v)) + pc_dot(tb, pc_angular_velocity(b)) - pc_dot(ta, pc_angular_velocity(a));
  precise Real response = pc_dot(impulse, impulse) * (a.inverse_mass + b.inverse_mass) +
                          pc_dot(ta, pc_sym_mul(a.inertia, ta)) * a.response +
                          pc_dot(tb, pc_sym_mul(b.inertia, tb)) * b.response;
  precise Real least = -rate * pc_inverse_or_zero(response);
  return least;
}
