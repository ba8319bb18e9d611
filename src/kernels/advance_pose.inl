// How a pose moves with the velocities in a sub-step.
// Position: p + h u as a sum of two reals (Knuth's two-sum), so that motion below the last place is kept; the
// orientation is such a sum too, of which the change of the sub-step is computed, not the rotated whole: a million
// small turns in single precision would otherwise add up a million roundings of 6e-8 (docs/integrate.md).
// Rotation: free_rotation.inl.
// Where every body has three equal moments (PC_ROUND) only that rotation is left: the same bits, less work.
// Where no body rotates (PC_STILL) it is left out.
// The original's scheme (PC_SEED) has no gyroscopic terms: w is constant, so that L = I w turns as the body does.

PC_FN Vec3 pc_move(PC_IO PC_INOUT(BodyPose) p, Quad linear) {
  Vec3 step = pc_scale(linear.v, PC_INFO(h));
  TwoSum place = pc_two_sum(p.place.v, pc_add(p.place_low.v, step));
  p.place.v = place.sum;
  p.place_low.v = pc_snap3(place.low);
  return step;
}

#ifndef PC_STILL
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

// `before` and `change` are of the orientation: what it was, and what was added to it.
struct Moved {
  Vec3 step;
  Quaternion before;
  Quaternion change;
};
PC_FN Moved pc_advance(PC_IO PC_INOUT(BodyPose) p, Quad linear, PC_INOUT(Quad) angular, Quad inverse) {
  Real h = PC_INFO(h);
  Moved moved;
  moved.step = pc_move(PC_PASS p, linear);
  Quaternion q = pc_quaternion(p.turned.v, p.turned.s);
  moved.before = q;
#ifdef PC_SEED
  Vec3 w0 = pc_sym_mul(pc_world_inertia(q, inverse.v), angular.v);
  Turn spin = pc_turn(pc_scale(w0, h));
  moved.change = pc_quaternion_mul(pc_quaternion(spin.q.v, spin.fall), q);
  angular.v = pc_select3(linear.s > PC_REAL(0.0), pc_rotate(spin.q, angular.v), angular.v);
#else
  moved.change = pc_free_rotation(q, angular.v, inverse, h);
#endif
  Turned next = pc_turned(q, p.turned_low, moved.change);
  p.turned = next.q;
  p.turned_low = next.low;
  return moved;
}
#endif
