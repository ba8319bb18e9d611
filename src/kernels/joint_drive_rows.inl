// Coefficients of a joint's motor and spring rows, and visits to them. Needs joint_rows.inl, drive_terms.inl.
PC_FN void pc_st3_drive(PC_IO Slot m, uint f, Vec3 v) {
  PC_ST(joint_rows, m, f, v.x);
  PC_ST(joint_rows, m, f + 1u, v.y);
  PC_ST(joint_rows, m, f + 2u, v.z);
}

PC_FN void pc_drive_coefficient(PC_IO Slot m, uint i, Real answer) {
  DriveRow r =
      pc_drive_row(PC_INFO(h), PC_LD(joint_rows, m, JOINT_DRIVE_KICK), PC_LD(joint_rows, m, JOINT_DRIVE_STIFFNESS),
                   PC_LD(joint_rows, m, JOINT_DRIVE_DAMPING), PC_LD(joint_rows, m, JOINT_DRIVE_AWAY + i),
                   PC_LD(joint_rows, m, JOINT_DRIVE_LAST + i), answer);
  PC_ST(joint_rows, m, JOINT_DRIVE_GAMMA + i, r.gamma);
  PC_ST(joint_rows, m, JOINT_DRIVE_PUSH + i, r.push);
  PC_ST(joint_rows, m, JOINT_DRIVE_ANSWER + i, answer);
}
// `answers`: velocity per impulse of the three rows.
PC_FN void pc_drive_coefficients(PC_IO Slot m, Vec3 answers) {
  pc_drive_coefficient(PC_PASS m, 0u, answers.x);
  pc_drive_coefficient(PC_PASS m, 1u, answers.y);
  pc_drive_coefficient(PC_PASS m, 2u, answers.z);
}

// Change of a soft row's impulse `total` at the velocity u: afterwards total = -(push + gamma u').
PC_FN Real pc_soft_change(PC_IO Slot m, uint i, Real u, Real total) {
  Real gamma = PC_LD(joint_rows, m, JOINT_DRIVE_GAMMA + i);
  precise Real lack = PC_LD(joint_rows, m, JOINT_DRIVE_PUSH + i) + gamma * u + total;
  precise Real all = PC_REAL(1.0) + gamma * PC_LD(joint_rows, m, JOINT_DRIVE_ANSWER + i);
  return -pc_div(lack, all);
}
// The spring's three rows, then the motor's, from the relative angular velocity w; answers their couple.
// `both`: how w answers one.
PC_FN Vec3 pc_drive_steps(PC_IO Slot m, Vec3 w, Sym3 both) {
  Real kind = PC_LD(joint_rows, m, JOINT_DRIVE);
  Mask driven = pc_and(kind > PC_REAL(0.5), kind < PC_REAL(2.0));
  Vec3 couple = pc_zero3();
  Real zero = PC_REAL(0.0);
  if (!PC_ANY(driven)) return couple;  // lint: allow (zeros otherwise)
  for (uint i = 0u; i < 3u; i++) {
    Vec3 axis = pc_ld3_joint(PC_PASS m, JOINT_DRIVE_AXIS + i * 3u);
    Real total = PC_LD(joint_rows, m, JOINT_DRIVE_TOTAL + i);
    Real change = pc_select(driven, pc_soft_change(PC_PASS m, i, pc_dot(axis, w), total), zero);
    precise Real next = total + change;
    PC_ST(joint_rows, m, JOINT_DRIVE_TOTAL + i, next);
    Vec3 step = pc_scale(axis, change);
    couple = pc_add(couple, step);
    w = pc_add(w, pc_sym_mul(both, step));
  }
  Vec3 axis = pc_ld3_joint(PC_PASS m, JOINT_DRIVE_AXIS);
  Real total = PC_LD(joint_rows, m, JOINT_MOTOR_TOTAL);
  Real most = PC_LD(joint_rows, m, JOINT_MOTOR_MOST);
  precise Real wanted = total - (pc_dot(axis, w) - PC_LD(joint_rows, m, JOINT_MOTOR_SPEED)) *
                                    pc_inverse_or_zero(PC_LD(joint_rows, m, JOINT_DRIVE_ANSWER));
  Real next = pc_select(driven, pc_clamp(wanted, -most, most), total);
  precise Real change = next - total;
  PC_ST(joint_rows, m, JOINT_MOTOR_TOTAL, next);
  return pc_madd(couple, axis, change);
}
// What a spring gives beyond stopping its ends: it turns no body by more than `stale_share` in the sub-step. Where
// bodies turn further its points leave its line and it stays as long as it is: what it gave would be made of nothing.
// `turns_a`, `turns_b`: angular velocities that a unit impulse along it makes.
PC_FN Real pc_spring_most(PC_IO Vec3 turns_a, Vec3 turns_b) {
  Real turns = pc_sqrt(pc_max(pc_dot(turns_a, turns_a), pc_dot(turns_b, turns_b)));
  precise Real most = PC_INFO(inverse_h) * PC_INFO(stale_share) * pc_inverse_or_zero(turns);
  return most;
}
// Change of a spring's impulse on b at the relative velocity of its ends; what it was points along the line of the last
// sub-step. What brings them to rest takes energy, whatever it is.
PC_FN Vec3 pc_spring_change(PC_IO Slot m, Vec3 rate, Vec3 impulse) {
  Vec3 axis = pc_ld3_joint(PC_PASS m, JOINT_DRIVE_AXIS);
  Real zero = PC_REAL(0.0);
  Real total = pc_dot(axis, impulse);
  Real speed = pc_dot(axis, rate);
  Real most = PC_LD(joint_rows, m, JOINT_MOTOR_MOST);
  precise Real wanted = total + pc_soft_change(PC_PASS m, 0u, speed, total);
  precise Real stops = total - speed * pc_inverse_or_zero(PC_LD(joint_rows, m, JOINT_DRIVE_ANSWER));
  precise Real least = stops - most;
  precise Real largest = stops + most;
  Real within = pc_clamp(wanted, pc_min(zero, least), pc_max(zero, largest));
  Real next = pc_select(most > zero, within, wanted);
  return pc_sub(pc_scale(axis, next), impulse);
}
PC_FN Mask pc_is_spring(PC_IO Slot m) { return PC_LD(joint_rows, m, JOINT_DRIVE) > PC_REAL(1.0); }
