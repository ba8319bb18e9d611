// Impulses on the two bodies of a slot, and the stores of what they change. A body that stands is never stored: slots
// beside each other may share it.
#include "body_state.inl"

PC_FN Vec3 pc_pushed(Vec3 v, Vec3 impulse, Real inverse_mass) { return pc_madd(v, impulse, inverse_mass); }

PC_FN void pc_store_states(PC_IO Index ia, Index ib, BodyState a, BodyState b) {
  PC_SCATTER_IF(a.inverse_mass > PC_REAL(0.0), motion, ia, 0u, pc_quad(a.v, a.inverse_mass));
  PC_SCATTER_IF(a.inverse_mass > PC_REAL(0.0), motion, ia, 1u, pc_quad(a.l, a.phase));
  PC_SCATTER_IF(b.inverse_mass > PC_REAL(0.0), motion, ib, 0u, pc_quad(b.v, b.inverse_mass));
  PC_SCATTER_IF(b.inverse_mass > PC_REAL(0.0), motion, ib, 1u, pc_quad(b.l, b.phase));
}
// Bodies of a slot that does not push are not stored either.
PC_FN void pc_spare(PC_INOUT(BodyState) b, Mask pushes) {
  b.inverse_mass = pc_select(pushes, b.inverse_mass, PC_REAL(0.0));
}
// On those of the two that stand in no tree; of the others only the phase is stored.
PC_FN void pc_apply_free(PC_IO Index ia, Index ib, PC_INOUT(BodyState) a, PC_INOUT(BodyState) b, Mask tree_a,
                         Mask tree_b, Vec3 impulse, Vec3 torque_a, Vec3 torque_b) {
  Real zero = PC_REAL(0.0);
  Real mass_a = pc_select(tree_a, zero, -a.inverse_mass);
  Real mass_b = pc_select(tree_b, zero, b.inverse_mass);
  a.v = pc_pushed(a.v, impulse, mass_a);
  b.v = pc_pushed(b.v, impulse, mass_b);
  a.l = pc_madd(a.l, torque_a, pc_select(tree_a, zero, -a.response));
  b.l = pc_madd(b.l, torque_b, pc_select(tree_b, zero, b.response));
  pc_store_states(PC_PASS ia, ib, a, b);
}
