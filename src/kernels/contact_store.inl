// Writes what lasts of the impulses back to the contact, friction as a world vector: the tangents are chosen
// anew each step.
#include "contact_rows.inl"
#include "contact_lasting.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Index record = PC_ORDER(contact_order, m);
  Vec3 n = pc_ld3_rows(PC_PASS m, ROW_N); Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T); Vec3 t2 = pc_cross(n, t1);
  Lasting l = pc_lasting(PC_PASS m);
  precise Vec3 friction = (t1 * PC_LD(contact_impulses, m, IMPULSE_T) + t2 * PC_LD(contact_impulses, m, IMPULSE_T + 1u)) * l.share;
  precise Real twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u) * l.share;
  PC_SCATTER(contact, record, 5u, pc_quad(Vec3(l.l0, l.l1, l.l2), l.l3));
  PC_SCATTER(contact, record, 8u, pc_quad(Vec3(pc_snap(PC_LD(contact_impulses, m, IMPULSE_MEAN)), pc_snap(PC_LD(contact_impulses, m, IMPULSE_MEAN + 1u)), pc_snap(PC_LD(contact_impulses, m, IMPULSE_MEAN + 2u))), pc_snap(PC_LD(contact_impulses, m, IMPULSE_MEAN + 3u))));
  PC_SCATTER(contact, record, 6u, pc_quad(pc_snap3(friction), pc_snap(twist)));
}
