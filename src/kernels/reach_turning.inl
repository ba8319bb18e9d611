// Whether a contact has rows of couples. Needs tree_reach.inl.
// A manifold of one point has no rows but those of impulses (once it has let go of the twist of two), nor has one that
// is left alone.
PC_FN Mask pc_turns_matter(PC_IO Slot m) {
  Mask acts = PC_LD(contact_rows, m, ROW_ACTS) > PC_REAL(0.0);
  return pc_and(acts, pc_or(PC_LD(contact_rows, m, ROW_RADIUS) > PC_REAL(0.0),
                            pc_abs(PC_LD(contact_impulses, m, IMPULSE_T + 2u)) > PC_REAL(0.0)));
}
PC_FN uint pc_turning(PC_IO Way w, Slot m) { return PC_ANY(pc_turns_matter(PC_PASS m)) ? pc_reach_all(w) : 0u; }
