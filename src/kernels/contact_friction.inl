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
