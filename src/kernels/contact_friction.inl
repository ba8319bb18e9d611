// Friction on top of what the manifold has accumulated. What sticks is judged by the load at the start of the sub-step
// where that is larger: the soft rows let go of some of it for a moment, and a body that has begun to slide goes on.
#include "contact_coulomb.inl"

PC_FN Friction pc_friction(PC_IO Slot m, Twist v, Real load, Real mass_scale) {
  Real holding = pc_select(load > PC_REAL(0.0), pc_max(load, PC_LD(contact_impulses, m, IMPULSE_BEFORE)), load);
  return pc_coulomb(PC_PASS m, v, load, holding, mass_scale, PC_LD(contact_impulses, m, IMPULSE_T), PC_LD(contact_impulses, m, IMPULSE_T + 1u), PC_LD(contact_impulses, m, IMPULSE_T + 2u));
}
