// Rows know small turns only: a body whose moments differ answers otherwise once it has turned. The inverse inertia
// changes by about (largest / smallest - 1) angle^2 of its smallest part; from a tenth of that on a manifold is
// refreshed. (the turn of this sub-step, which lies ahead, counts as well: what is remembered is of the one before)
PC_FN Mask pc_turns_far(PC_IO BodyState b, Quad moved) {
  Vec3 w = pc_angular_velocity(b);
  Real h = PC_INFO(h);
  precise Real turn = (moved.s + pc_dot(w, w) * h * h) * b.unlike;
  return turn > PC_INFO(stale_share);
}
