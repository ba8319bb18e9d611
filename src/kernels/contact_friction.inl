// Friction on top of what the manifold has accumulated.
#include "contact_coulomb.inl"

PC_FN Friction pc_friction(PC_IO Slot m, Twist v, Real load) {
#ifdef PC_FRICTIONLESS
  return pc_no_friction(v);
#else
  return pc_coulomb(PC_PASS m, v, load, PC_LD(contact_impulses, m, IMPULSE_T),
                    PC_LD(contact_impulses, m, IMPULSE_T + 1u), PC_LD(contact_impulses, m, IMPULSE_T + 2u));
#endif
}
// Of their impulses; the twist after them is left as b has it.
PC_FN Friction pc_select_friction(Mask m, Friction a, Friction b) {
  Friction r = b;
  r.next1 = pc_select(m, a.next1, b.next1);
  r.next2 = pc_select(m, a.next2, b.next2);
  r.next_twist = pc_select(m, a.next_twist, b.next_twist);
  r.change1 = pc_select(m, a.change1, b.change1);
  r.change2 = pc_select(m, a.change2, b.change2);
  r.change_twist = pc_select(m, a.change_twist, b.change_twist);
  return r;
}
// Where it does not act the impulses stay as they are.
PC_FN void pc_store_friction(PC_IO Slot m, Friction f, Mask acts) {
#ifndef PC_FRICTIONLESS
  Real before1 = PC_LD(contact_impulses, m, IMPULSE_T);
  Real before2 = PC_LD(contact_impulses, m, IMPULSE_T + 1u);
  Real before_twist = PC_LD(contact_impulses, m, IMPULSE_T + 2u);
  PC_ST(contact_impulses, m, IMPULSE_T, pc_select(acts, f.next1, before1));
  PC_ST(contact_impulses, m, IMPULSE_T + 1u, pc_select(acts, f.next2, before2));
  PC_ST(contact_impulses, m, IMPULSE_T + 2u, pc_select(acts, f.next_twist, before_twist));
#endif
}
