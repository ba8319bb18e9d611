// The share of what its contacts remember that acts on a body. A load that lasts is balanced, or undoes what forces did; a blow, and what presses
// on a body from all sides and has turned against it, is no load: repeated it would be energy. So what is remembered may make a body faster, but
// by no more than struck_speed^2 / N, where N is how much its velocity has changed since this was asked in the sub-step before: little where
// it was struck, much where it lies still under a load that it is just taking up. (In a step's first sub-step N is what it would
// change now.)
PC_FN void pc_kernel(PC_IO Index i) {
  Quad motion_now = PC_GATHER(motion, i, 0u); Quad sum = PC_GATHER(recalled, i, 0u); Quad last = PC_GATHER(recalled, i, 1u); Quad struck = PC_GATHER(delta, i, 2u);
  Real zero = PC_REAL(0.0); Real one = PC_REAL(1.0);
  Vec3 v = pc_scale(sum.v, pc_select(sum.s > zero, sum.s, motion_now.s)); Vec3 away = pc_sub(motion_now.v, last.v);
  Real own = pc_dot(motion_now.v, motion_now.v); Real rate = pc_dot(motion_now.v, v); Real change = pc_dot(v, v);
  Real changed = pc_select(struck.s > PC_REAL(0.5), pc_dot(away, away), change);
  precise Real square = PC_INFO(struck_speed) * PC_INFO(struck_speed); precise Real growth = square * pc_inverse_or_zero(pc_sqrt(changed));
  precise Real room = growth * (PC_REAL(2.0) * pc_sqrt(own) + growth);
  precise Real more = change + rate * PC_REAL(2.0); Mask limited = pc_and(changed > zero, more > room);
  precise Real under = rate * rate + change * room; precise Real least = rate + pc_sqrt(pc_select(limited, under, zero));
  Real part = pc_min(pc_div(room, pc_max(least, PC_TINY)), one); Mask held = change < PC_INFO(largest_impulse);
  struck.v.z = pc_select(limited, pc_select(held, pc_snap(part), zero), one); struck.s = one;
  Mask moves = motion_now.s > zero;
  PC_SCATTER_IF(moves, delta, i, 2u, struck);
  PC_SCATTER_IF(moves, recalled, i, 0u, pc_quad(pc_zero3(), zero)); PC_SCATTER_IF(moves, recalled, i, 1u, pc_quad(motion_now.v, zero));
}
