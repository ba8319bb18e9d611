// A step begins with nothing pushed. Once the bodies have moved: takes back what pushed those in no tree out of trees
// (tree_contact_push). The impulse acted where the body was: its moment about where that is now is another one.
#include "body_state.inl"
#include "tree_math.inl"

PC_FN void pc_kernel(PC_IO Index i) {
  if (PC_ANY(PC_INFO(begins) > PC_REAL(0.5))) {  // lint: allow (the same for all lanes)
    PC_SCATTER(pushed, i, 0u, pc_quad(pc_zero3(), PC_REAL(0.0)));
    PC_SCATTER(pushed, i, 1u, pc_quad(pc_zero3(), PC_REAL(0.0)));
    return;
  }
  Quad impulse = PC_GATHER(pushed, i, 0u);
  Quad torque = PC_GATHER(pushed, i, 1u);
  Mask some = pc_max(pc_largest(impulse.v), pc_largest(torque.v)) > PC_REAL(0.0);
  if (!PC_ANY(some)) return;  // lint: allow (nothing changes nothing)
  BodyState b = pc_body_state(PC_PASS i);
  precise Vec3 moment = torque.v - pc_cross(pc_scale(b.v, PC_INFO(h)), impulse.v);
  precise Real minus_mass = -b.inverse_mass;
  precise Real minus_response = -b.response;
  PC_SCATTER_IF(some, motion, i, 0u, pc_quad(pc_madd(b.v, impulse.v, minus_mass), b.inverse_mass));
  PC_SCATTER_IF(some, motion, i, 1u, pc_quad(pc_madd(b.l, moment, minus_response), b.phase));
  PC_SCATTER_IF(some, pushed, i, 0u, pc_quad(pc_zero3(), PC_REAL(0.0)));
  PC_SCATTER_IF(some, pushed, i, 1u, pc_quad(pc_zero3(), PC_REAL(0.0)));
}
