// Stage 1 of a sub-step: forces and drag. With F the drag, a the acceleration:
//   u' = u + a h phi(F h) - (1 - e^(-F h)) u,   L' = L + T h phi(G h) - (1 - e^(-G h)) L
// which is exact for constant a, T (errata vi of the method); then the inertia of the new sub-step.
// Without drag (PC_DRAG not defined) phi = 1: the same bits, less work.
#include "world_inertia.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad push = PC_GATHER(force, i, 0u);
  Quad turn = PC_GATHER(force, i, 1u);
  Real h = PC_INFO(h);

  Mask dynamic_body = linear.s > PC_REAL(0.0);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 acceleration = pc_madd(gravity, push.v, linear.s);
#ifdef PC_DRAG
  precise Real x = push.s * h;
  precise Real y = turn.s * h;
  Decay slow = pc_decay(x);
  Decay calm = pc_decay(y);
  precise Real kick = slow.phi * h;
  precise Real twist = calm.phi * h;
  precise Vec3 u = linear.v + (acceleration * kick - linear.v * slow.loss);
  precise Vec3 l = angular.v + (turn.v * twist - angular.v * calm.loss);
#else
  precise Vec3 u = linear.v + acceleration * h;
  precise Vec3 l = angular.v + turn.v * h;
#endif
  linear.v = pc_select3(dynamic_body, pc_snap3(u), linear.v);
  angular.v = pc_select3(dynamic_body, pc_snap3(l), angular.v);
  angular.s = PC_REAL(0.0);
  PC_SCATTER(motion, i, 0u, linear);
  PC_SCATTER(motion, i, 1u, angular);
  pc_store_inertia(PC_PASS i, linear.s);
}
