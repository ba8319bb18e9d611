// Motors and springs of a tree's joints inside its factor: soft rows on the relative rotation, as the angle rows are. A
// motor is a locked row of the wanted speed until it needs more than its torque; then it is that torque, found like the
// limits that act.
#include "drive_terms.inl"
#include "tree_drive_rows.inl"

PC_FN Mask pc_has_drive(PC_IO Slot n) { return PC_LD(tree_drive_rows, n, DRIVE_IS) > PC_REAL(0.5); }
// Whether it is a motor or has stiffness: does more than damp.
PC_FN Mask pc_drive_moves(PC_IO Slot n) {
  Real kind = PC_LD(tree_drive_rows, n, DRIVE_IS);
  return pc_and(kind > PC_REAL(0.5), kind < PC_REAL(2.0));
}

// A joint with a motor or a spring, not in its first sub-step: what it turns would be slowed by a floor for pins
// of unknown stiffness.
PC_FN Mask pc_drive_lasts(PC_IO Slot n) {
  return pc_and(pc_has_drive(PC_PASS n), PC_LD(tree_drive_rows, n, DRIVE_FRESH) < PC_REAL(0.5));
}

// Before the first round: rates at the prediction. Run after pc_tree_residual, whose TREE_X holds velocities.
PC_FN void pc_drive_rates(PC_IO Slot n, Slot up) {
  Mask driven = pc_has_drive(PC_PASS n);
  if (!PC_ANY(driven)) return;  // lint: allow (nothing reads them otherwise)
  Vec3 turn =
      pc_select3(driven, pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u)), pc_zero3());
  pc_st3_drive(PC_PASS n, DRIVE_RATE, turn);
  PC_ST(tree_drive_rows, n, MOTOR_ON, pc_select(driven, PC_REAL(2.0), PC_LD(tree_drive_rows, n, MOTOR_ON)));
  Mask moves = pc_drive_moves(PC_PASS n);
  if (!PC_ANY(moves)) return;  // lint: allow (the world's axes)
  Vec3 along =
      Vec3(pc_dot(pc_ld3_drive(PC_PASS n, DRIVE_AXIS), turn), pc_dot(pc_ld3_drive(PC_PASS n, DRIVE_AXIS + 3u), turn),
           pc_dot(pc_ld3_drive(PC_PASS n, DRIVE_AXIS + 6u), turn));
  pc_st3_drive(PC_PASS n, DRIVE_RATE, pc_select3(moves, along, turn));
}

// The motor: adds its stiffness where it holds, and answers its impulse at the prediction. `answer`: of both sides
// about its axis.
PC_FN Real pc_motor_push(PC_IO Slot n, Vec3 axis, Sym3 loose, Real answer, Mask driven) {
  Real most = PC_LD(tree_drive_rows, n, MOTOR_MOST);
  Real on = PC_LD(tree_drive_rows, n, MOTOR_ON);
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  precise Real beyond = PC_LD(tree_drive_rows, n, DRIVE_RATE) - PC_LD(tree_drive_rows, n, MOTOR_SPEED);
  // not known yet: by what it would take without loads
  precise Real need = pc_abs(beyond) * pc_inverse_or_zero(answer);
  Real side = pc_select(beyond > zero, -one, one);
  Real state = pc_select(on > PC_REAL(1.0), pc_select(need > most, side, zero), on);
  Mask holds = pc_and(most > zero, pc_abs(state) < PC_REAL(0.5));
  precise Real lock = PC_INFO(lock_stiffness) * pc_inverse_or_zero(pc_dot(axis, pc_sym_mul(loose, axis)));
  Real stiffness = pc_select(holds, lock, zero);
  PC_ST(tree_drive_rows, n, MOTOR_ON, pc_select(driven, state, on));
  PC_ST(tree_drive_rows, n, MOTOR_STIFFNESS, stiffness);
  precise Real pull = stiffness * beyond - state * most;
  return pull;
}
#define PC_MOST_DAMPED PC_REAL(300.0)
// D with what only damps in it, all axes at once and so without any of the joint's: drive_terms.inl's sigma as a
// matrix, y^2 (1 + y^2)^-1 with y = h c / m. Beyond a trace of 300 y is scaled down, or rounding of its square would
// swamp the 1. `push`: the couple that it lacks at the prediction.
struct Driven {
  Sym3 freedom;
  Vec3 push;
};
PC_FN Driven pc_with_damper(PC_IO Slot n, Slot up, Sym3 bare, Sym3 loose) {
  Sym3 answer = pc_sym_add(loose, pc_sym_inverse(pc_lds_tree(PC_PASS up, TREE_BODY)));
  Real one = PC_REAL(1.0);
  Real most = PC_MOST_DAMPED;
  precise Real damping = PC_LD(tree_drive_rows, n, DRIVE_DAMPING) * PC_LD(tree_drive_rows, n, DRIVE_KICK);
  precise Real trace = (answer.xx + answer.yy + answer.zz) * damping;
  precise Real scale = damping * pc_div(most, pc_max(trace, most));
  precise Real half_damping = damping * PC_REAL(0.5);
  Sym3 y = pc_sym_scale(answer, scale);
  Vec3 y0 = pc_row0(y);
  Vec3 y1 = pc_row1(y);
  Vec3 y2 = pc_row2(y);
  // h c (1 - sigma) / 2
  Sym3 early =
      pc_sym_scale(pc_sym_inverse(pc_sym_add(pc_diagonal(one), pc_products(y0, y1, y2, y0, y1, y2))), half_damping);
  Sym3 gamma = pc_sym_sub(pc_diagonal(damping), early);
  Driven d;
  d.freedom = pc_sym_add(bare, gamma);
  d.push = pc_add(pc_sym_mul(gamma, pc_ld3_drive(PC_PASS n, DRIVE_RATE)),
                  pc_sym_mul(early, pc_ld3_drive(PC_PASS n, DRIVE_LAST)));
  return d;
}
// With motor and spring.
PC_FN Driven pc_with_motor(PC_IO Slot n, Slot up, Sym3 bare, Sym3 loose, Mask driven) {
  Sym3 above = pc_sym_inverse(pc_lds_tree(PC_PASS up, TREE_BODY));
  Sym3 freedom = bare;
  Vec3 push = pc_zero3();
  Real zero = PC_REAL(0.0);
  Real h = PC_INFO(h);
  Real kick = PC_LD(tree_drive_rows, n, DRIVE_KICK);
  Real stiffness = PC_LD(tree_drive_rows, n, DRIVE_STIFFNESS);
  Real damping = PC_LD(tree_drive_rows, n, DRIVE_DAMPING);
  for (uint i = 0u; i < 3u; i++) {
    Vec3 axis = pc_ld3_drive(PC_PASS n, DRIVE_AXIS + i * 3u);
    precise Real answer = pc_dot(axis, pc_sym_mul(loose, axis)) + pc_dot(axis, pc_sym_mul(above, axis));
    DriveRow r = pc_drive_row(h, kick, stiffness, damping, PC_LD(tree_drive_rows, n, DRIVE_AWAY + i),
                              PC_LD(tree_drive_rows, n, DRIVE_LAST + i), answer);
    precise Real pull = r.push + r.gamma * PC_LD(tree_drive_rows, n, DRIVE_RATE + i);
    freedom = pc_sym_outer(freedom, axis, pc_select(driven, r.gamma, zero));
    push = pc_madd(push, axis, pull);
    if (i == 0u) {
      Real motor = pc_motor_push(PC_PASS n, axis, loose, answer, driven);
      push = pc_madd(push, axis, motor);
      freedom = pc_sym_outer(freedom, axis, pc_select(driven, PC_LD(tree_drive_rows, n, MOTOR_STIFFNESS), zero));
    }
  }
  Driven d;
  d.freedom = freedom;
  d.push = push;
  return d;
}
// D with what drives the joint in it. Afterwards DRIVE_PUSH is the couple that it lacks at the prediction.
PC_FN Sym3 pc_with_drives(PC_IO Slot n, Slot up, Sym3 bare, Sym3 loose) {
  Mask driven = pc_has_drive(PC_PASS n);
  Mask moves = pc_drive_moves(PC_PASS n);
  Driven d = pc_with_damper(PC_PASS n, up, bare, loose);
  d.freedom = pc_sym_select(driven, d.freedom, bare);
  d.push = pc_select3(driven, d.push, pc_zero3());
  if (PC_ANY(moves)) {  // lint: allow (others keep what they have)
    Driven motor = pc_with_motor(PC_PASS n, up, bare, loose, moves);
    d.freedom = pc_sym_select(moves, motor.freedom, d.freedom);
    d.push = pc_select3(moves, motor.push, d.push);
  }
  pc_st3_drive(PC_PASS n, DRIVE_PUSH, d.push);
  return d.freedom;
}

// After a sweep: a motor that would need more than its torque gets that; in the first round one that is past its speed
// holds it. 1 where any changed.
PC_FN Real pc_drive_revise(PC_IO Slot n, Slot up, bool may_hold) {
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  Mask driven = pc_drive_moves(PC_PASS n);
  if (!PC_ANY(driven)) return zero;  // lint: allow (nothing changes otherwise)
  Vec3 turn = pc_sub(pc_ld3_tree(PC_PASS n, TREE_X + 3u), pc_ld3_tree(PC_PASS up, TREE_X + 3u));
  Real most = PC_LD(tree_drive_rows, n, MOTOR_MOST);
  Real on = PC_LD(tree_drive_rows, n, MOTOR_ON);
  precise Real beyond = PC_LD(tree_drive_rows, n, DRIVE_RATE) + pc_dot(pc_ld3_drive(PC_PASS n, DRIVE_AXIS), turn) -
                        PC_LD(tree_drive_rows, n, MOTOR_SPEED);
  precise Real impulse = -PC_LD(tree_drive_rows, n, MOTOR_STIFFNESS) * beyond;
  precise Real past = beyond * on;
  Mask has = pc_and(driven, most > zero);
  Mask yields = pc_and(has, pc_and(pc_abs(on) < PC_REAL(0.5), pc_abs(impulse) > most));
  Mask holds = pc_and(pc_and(has, PC_IS(may_hold ? 1u : 0u)), past > zero);
  PC_ST(tree_drive_rows, n, MOTOR_ON,
        pc_select(yields, pc_select(impulse > zero, one, -one), pc_select(holds, zero, on)));
  return pc_select(pc_or(yields, holds), one, zero);
}
