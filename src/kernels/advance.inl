// End of a sub-step: the pose moves with the velocities.
// Position: p + h u as a sum of two reals (Knuth's two-sum), so that motion below the last place is kept; the
// orientation is such a sum too, of which the change of the sub-step is computed, not the rotated whole: a million
// small turns in single precision would otherwise add up a million roundings of 6e-8 (docs/integrate.md).
// Rotation: free_rotation.inl.
// Where every body has three equal moments (PC_ROUND) only that rotation is left: the same bits, less work.
// The original's scheme (PC_SEED) has no gyroscopic terms: w is constant, so that L = I w turns as the body does.

#ifdef PC_ROUND
PC_FN Quaternion pc_free_rotation(Quaternion q, Vec3 l, Quad inverse, Real h) {
  precise Real world_time = inverse.v.x * h;
  Turn world = pc_turn(pc_scale(l, world_time));
  return pc_quaternion_mul(pc_quaternion(world.q.v, world.fall), q);
}
#elif !defined(PC_SEED)
#include "free_rotation.inl"
#endif

#include "turned.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad inverse = PC_GATHER(mass, i, 1u);
  Quad place = PC_GATHER(pose, i, 0u);
  Quad turned = PC_GATHER(pose, i, 1u);
  Quad place_low = PC_GATHER(pose, i, 2u);
  Quad turned_low = PC_GATHER(pose, i, 3u);
  Quad moved = PC_GATHER(delta, i, 0u);
  Quad rotated = PC_GATHER(delta, i, 1u);
  Real h = PC_INFO(h);

  Vec3 step = pc_scale(linear.v, h);
  TwoSum p = pc_two_sum(place.v, pc_add(place_low.v, step));
  place.v = p.sum; place_low.v = pc_snap3(p.low);

  Quaternion q = pc_quaternion(turned.v, turned.s);
#ifdef PC_SEED
  Vec3 w0 = pc_sym_mul(pc_world_inertia(q, inverse.v), angular.v);
  Turn spin = pc_turn(pc_scale(w0, h));
  Quaternion change = pc_quaternion_mul(pc_quaternion(spin.q.v, spin.fall), q);
  angular.v = pc_select3(linear.s > PC_REAL(0.0), pc_rotate(spin.q, angular.v), angular.v);
  PC_SCATTER(motion, i, 1u, angular);
#else
  Quaternion change = pc_free_rotation(q, angular.v, inverse, h);
#endif
  Turned next = pc_turned(q, turned_low, change);
  turned = next.q; turned_low = next.low;

  // the rotation itself: (q + change) q* = 1 + change q*
  Quaternion rotation = pc_quaternion_mul(change, pc_conjugate(q));
  Real two = pc_select(rotation.w < PC_REAL(-1.0), PC_REAL(-2.0), PC_REAL(2.0));
  moved.v = pc_add(moved.v, step);
  rotated.v = pc_madd(rotated.v, rotation.v, two);
  precise Real turned_square = moved.s + pc_dot(rotation.v, rotation.v) * PC_REAL(4.0); moved.s = turned_square;

  PC_SCATTER(pose, i, 0u, place);
  PC_SCATTER(pose, i, 1u, turned);
  PC_SCATTER(pose, i, 2u, place_low);
  PC_SCATTER(pose, i, 3u, turned_low);
  PC_SCATTER(delta, i, 0u, moved);
  PC_SCATTER(delta, i, 1u, pc_quad(rotated.v, rotated.s));
}
