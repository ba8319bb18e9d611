// The share of what its contacts remember that acts on a body.
//
// A load that lasts is balanced, or undoes what forces did. A blow is no load, nor is what presses on a body from all
// sides and has turned against it: repeated they would be energy. So what is remembered may make a body faster, but by
// no more than struck_speed^2 / N, where N is how much its velocity has changed since this was asked in the sub-step
// before: little where it was struck, much where it lies still under a load that it is just taking up. In a step's
// first sub-step N is what it would change now.

PC_FN void pc_kernel(PC_IO Index i) {
  Real zero = PC_REAL(0.0);
  Real one = PC_REAL(1.0);
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad sum = PC_GATHER(recalled, i, 0u);
  Quad last = PC_GATHER(recalled, i, 1u);
  Quad struck = PC_GATHER(delta, i, 2u);
  Mask moves = linear.s > zero;
  Mask in_tree = sum.s > zero;
  Mask again = struck.s > PC_REAL(0.5);
  // what it would change, and what has changed
  Vec3 kick = pc_scale(sum.v, pc_select(in_tree, sum.s, linear.s));
  Vec3 changed = pc_select3(again, pc_sub(linear.v, last.v), kick);
  precise Real square = PC_INFO(struck_speed) * PC_INFO(struck_speed);
  Real n_squared = pc_dot(changed, changed);
  precise Real growth = square * pc_inverse_or_zero(pc_sqrt(n_squared));
  // |v + x kick|^2 = (|v| + growth)^2, for the largest x up to 1
  Real along = pc_dot(linear.v, kick);
  Real kick_squared = pc_dot(kick, kick);
  Real speed = pc_sqrt(pc_dot(linear.v, linear.v));
  precise Real room = growth * (PC_REAL(2.0) * speed + growth);
  precise Real more = kick_squared + along * PC_REAL(2.0);
  Mask limited = pc_and(n_squared > zero, more > room);
  precise Real under = along * along + kick_squared * room;
  precise Real below = along + pc_sqrt(pc_select(limited, under, zero));
  Real part = pc_snap(pc_min(pc_div(room, pc_max(below, PC_TINY)), one));
  Mask is_number = kick_squared < PC_INFO(largest_momentum);
  struck.v.z = pc_select(limited, pc_select(is_number, part, zero), one);
  struck.s = one;
  PC_SCATTER_IF(moves, delta, i, 2u, struck);
  PC_SCATTER_IF(moves, recalled, i, 0u, pc_quad(pc_zero3(), zero));
  PC_SCATTER_IF(moves, recalled, i, 1u, pc_quad(linear.v, zero));
}
