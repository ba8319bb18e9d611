// How the sides of a contact meet, kept from tree_contact_prepare for the biased visit: what stands in trees or is
// fixed moves as it did then, but for what is pending. Needs contact_meeting.inl, tree_reach.inl.
PC_FN Real pc_free_mass(Mask in_tree, BodyState b) { return pc_select(in_tree, PC_REAL(0.0), b.inverse_mass); }

PC_FN void pc_keep3_reach(PC_IO Slot s, uint f, Vec3 v, Mask these) {
  pc_st3_reach(PC_PASS s, f, pc_select3(these, v, pc_ld3_reach(PC_PASS s, f)));
}
PC_FN void pc_keep_meeting(PC_IO Way w, Slot m, Meeting now, Mask these) {
  Slot s = PC_NODE(m, w.reach);
  Slot q = PC_NODE(m, w.reach + 1u);
  Twist v = now.twist;
  pc_keep3_reach(PC_PASS s, 0u, Vec3(v.v1, v.v2, v.vn), these);
  pc_keep3_reach(PC_PASS s, 3u, Vec3(v.w1, v.w2, v.wn), these);
  pc_keep3_reach(PC_PASS s, 6u, Vec3(now.shift.n, now.shift.turn1, now.shift.turn2), these);
  Real free =
      pc_max(pc_free_mass(pc_in_tree(PC_PASS w, m, 0u), now.a), pc_free_mass(pc_in_tree(PC_PASS w, m, 1u), now.b));
  PC_ST(contact_reach, s, 9u, pc_select(these, free, PC_LD(contact_reach, s, 9u)));
  pc_keep3_reach(PC_PASS q, 0u, now.arms.a, these);
  pc_keep3_reach(PC_PASS q, 3u, now.arms.b, these);
}
PC_FN BodyState pc_unmoved() {
  Real zero = PC_REAL(0.0);
  BodyState b;
  b.v = pc_zero3();
  b.l = b.v;
  b.inverse_mass = zero;
  b.phase = zero;
  b.response = zero;
  b.unlike = zero;
  b.inertia = pc_diagonal(zero);
  return b;
}
PC_FN Meeting pc_kept_meeting(PC_IO Way w, Slot m) {
  Slot s = PC_NODE(m, w.reach);
  Slot q = PC_NODE(m, w.reach + 1u);
  Meeting r;
  r.a = pc_unmoved();
  r.b = r.a;
  Vec3 v = pc_ld3_reach(PC_PASS s, 0u);
  Vec3 turn = pc_ld3_reach(PC_PASS s, 3u);
  Vec3 shift = pc_ld3_reach(PC_PASS s, 6u);
  r.twist.v1 = v.x;
  r.twist.v2 = v.y;
  r.twist.vn = v.z;
  r.twist.w1 = turn.x;
  r.twist.w2 = turn.y;
  r.twist.wn = turn.z;
  r.shift.n = shift.x;
  r.shift.turn1 = shift.y;
  r.shift.turn2 = shift.z;
  r.arms.a = pc_ld3_reach(PC_PASS q, 0u);
  r.arms.b = pc_ld3_reach(PC_PASS q, 3u);
  return r;
}
// Of a visit: as it was, unless time has passed since or some side is a free body.
PC_FN Meeting pc_meeting_now(PC_IO Way w, Slot m, Index ia, Index ib, Vec3 n, Vec3 t1, Vec3 t2) {
  Real passed = pc_max(PC_INFO(load_ahead), PC_LD(contact_reach, PC_NODE(m, w.reach), 9u));
  if (PC_ANY(passed > PC_REAL(0.0))) {  // lint: allow (the same numbers in lanes without)
    return pc_meeting(PC_PASS m, ia, ib, n, t1, t2);
  }
  return pc_kept_meeting(PC_PASS w, m);
}
