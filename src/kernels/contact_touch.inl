// After the last sub-step, where a host asks for events: with which impulses the points of a contact were pressed in
// this step, and how fast they had approached. A row that contact_impact stopped holds its impulses J in the place of
// its approach; responses give back the speeds that they stopped, (1 + e) v = the change of each row's velocity. Others
// hold the approach that the step began with, and the largest impulse of a sub-step, with what it bounced by.
#include "contact_rows.inl"
#include "contact_together.inl"

PC_FN Real pc_touch_impulse(PC_IO Slot m, uint i, Real approach) {
  precise Real all = PC_LD(contact_impulses, m, IMPULSE_LARGEST + i) + pc_max(approach, PC_REAL(0.0));
  return pc_snap(all);
}
// Of a row without an impact.
PC_FN Real pc_pressed_speed(PC_IO Slot m, uint i, Real approach) {
  return pc_select(PC_LD(contact_impulses, m, IMPULSE_LARGEST + i) > PC_REAL(0.0), pc_max(-approach, PC_REAL(0.0)),
                   PC_REAL(0.0));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index record = PC_ORDER(contact_order, m);
  Real zero = PC_REAL(0.0);
  Real a0 = PC_LD(contact_rows, m, ROW_APPROACH);
  Real a1 = PC_LD(contact_rows, m, ROW_APPROACH + 1u);
  Real a2 = PC_LD(contact_rows, m, ROW_APPROACH + 2u);
  Real a3 = PC_LD(contact_rows, m, ROW_APPROACH + 3u);
  Real l0 = pc_touch_impulse(PC_PASS m, 0u, a0);
  Real l1 = pc_touch_impulse(PC_PASS m, 1u, a1);
  Real l2 = pc_touch_impulse(PC_PASS m, 2u, a2);
  Real l3 = pc_touch_impulse(PC_PASS m, 3u, a3);

  Real j0 = pc_max(a0, zero);
  Real j1 = pc_max(a1, zero);
  Real j2 = pc_max(a2, zero);
  Real j3 = pc_max(a3, zero);
  Real k0 = pc_inverse_or_zero(PC_LD(contact_rows, m, ROW_MASS));
  Real k1 = pc_inverse_or_zero(PC_LD(contact_rows, m, ROW_MASS + 1u));
  Real k2 = pc_inverse_or_zero(PC_LD(contact_rows, m, ROW_MASS + 2u));
  Real k3 = pc_inverse_or_zero(PC_LD(contact_rows, m, ROW_MASS + 3u));
  Couplings d = pc_couplings(PC_PASS m);
  precise Real v0 = j0 * k0 + j1 * d.d01 + j2 * d.d02 + j3 * d.d03;
  precise Real v1 = j0 * d.d01 + j1 * k1 + j2 * d.d12 + j3 * d.d13;
  precise Real v2 = j0 * d.d02 + j1 * d.d12 + j2 * k2 + j3 * d.d23;
  precise Real v3 = j0 * d.d03 + j1 * d.d13 + j2 * d.d23 + j3 * k3;
  v0 = pc_select(j0 > zero, v0, zero);
  v1 = pc_select(j1 > zero, v1, zero);
  v2 = pc_select(j2 > zero, v2, zero);
  v3 = pc_select(j3 > zero, v3, zero);
  precise Real stopped = PC_LD(contact_rows, m, ROW_E) + PC_REAL(1.0);
  precise Real struck = pc_max(pc_max(v0, v1), pc_max(v2, v3)) * pc_inverse_or_zero(stopped);
  Real pressed = pc_max(pc_max(pc_pressed_speed(PC_PASS m, 0u, a0), pc_pressed_speed(PC_PASS m, 1u, a1)),
                        pc_max(pc_pressed_speed(PC_PASS m, 2u, a2), pc_pressed_speed(PC_PASS m, 3u, a3)));

  PC_SCATTER(touch, record, 0u, pc_quad(Vec3(l0, l1, l2), l3));
  PC_SCATTER(touch, record, 1u, pc_quad(Vec3(pc_snap(pc_max(struck, pressed)), zero, zero), zero));
}
