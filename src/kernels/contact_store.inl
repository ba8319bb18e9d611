// Writes what lasts of the impulses back to the contact, as those of one of the world's sub-steps; friction as a world
// vector: the tangents are chosen anew each step.
#include "contact_rows.inl"
#include "contact_lasting.inl"

#ifdef PC_FRICTIONLESS
PC_FN Quad pc_lasting_friction(PC_IO Slot m, Real share) { return pc_quad(pc_zero3(), PC_REAL(0.0)); }
#else
PC_FN Quad pc_lasting_friction(PC_IO Slot m, Real share) {
  Vec3 t1 = pc_ld3_rows(PC_PASS m, ROW_T);
  Vec3 t2 = pc_cross(pc_ld3_rows(PC_PASS m, ROW_N), t1);
  precise Vec3 friction =
      (t1 * PC_LD(contact_impulses, m, IMPULSE_T) + t2 * PC_LD(contact_impulses, m, IMPULSE_T + 1u)) * share;
  precise Real twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u) * share;
  return pc_quad(pc_snap3(friction), pc_snap(twist));
}
#endif

// Where bodies are so heavy that it is more than numbers hold nothing lasts.
PC_FN Real pc_load_of(Quad q) {
  precise Real load = pc_abs(q.v.x) + pc_abs(q.v.y) + pc_abs(q.v.z) + pc_abs(q.s);
  return load;
}
PC_FN Quad pc_kept_where(Mask held, Quad q) {
  return pc_quad(pc_select3(held, q.v, pc_zero3()), pc_select(held, q.s, PC_REAL(0.0)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Index record = PC_ORDER(contact_order, m);
  Lasting l = pc_lasting(PC_PASS m);
  Real ratio = PC_INFO(impulse_ratio);
  precise Real share = l.share * ratio;
  precise Real l0 = l.l0 * ratio;
  precise Real l1 = l.l1 * ratio;
  precise Real l2 = l.l2 * ratio;
  precise Real l3 = l.l3 * ratio;
  Quad normal = pc_quad(Vec3(l0, l1, l2), l3);
  Quad friction = pc_lasting_friction(PC_PASS m, share);
  precise Real all = pc_load_of(normal) + pc_load_of(friction);
  Mask held = all < PC_INFO(largest_momentum);
  PC_SCATTER(contact, record, 5u, pc_kept_where(held, normal));
  PC_SCATTER(contact, record, 6u, pc_kept_where(held, friction));
}
