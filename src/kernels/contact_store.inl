// Writes the impulses back to the contact, friction as a world vector: the tangents are chosen anew each step.
#include "contact_rows.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Index record = PC_ORDER(contact_order, m);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N); Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T); Vec3 t2 = pc_cross(n, t1);
  precise Vec3 friction = t1 * PC_LD(contact_impulses, m, IMPULSE_T) + t2 * PC_LD(contact_impulses, m, IMPULSE_T + 1u);
  PC_SCATTER(contact, record, 5u, pc_quad(Vec3(PC_LD(contact_impulses, m, 0u), PC_LD(contact_impulses, m, 1u), PC_LD(contact_impulses, m, 2u)), PC_LD(contact_impulses, m, 3u)));
  PC_SCATTER(contact, record, 6u, pc_quad(pc_snap3(friction), PC_LD(contact_impulses, m, IMPULSE_T + 2u)));
}
