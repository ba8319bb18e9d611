// What drag leaves of a velocity and what it takes. Up to F h = 1 what it takes is exact to the last place and is
// subtracted; above, nearly all of u goes (a velocity that was just set is stored e^(F h) times as large), and what
// is left is computed instead.
// A row of drag_terms as a Decay, and back.
PC_FN Decay pc_decay_of(Quad terms) {
  Decay d;
  d.e = terms.v.x;
  d.loss = terms.v.y;
  d.phi = terms.v.z;
  d.phi2 = terms.s;
  return d;
}
PC_FN Quad pc_terms_of(Decay d) { return pc_quad(Vec3(d.e, d.loss, d.phi), d.phi2); }
struct Share {
  Vec3 kept;
  Vec3 gone;
  Vec3 low;
};
PC_FN Share pc_share(Real drag_times_h, Vec3 v, Vec3 low, Decay d) {
  Mask strong = drag_times_h > PC_REAL(1.0);
  precise Vec3 left = v * d.e;
  precise Vec3 lost = v * d.loss;
  precise Vec3 left_low = low * d.e;
  Share s;
  s.kept = pc_select3(strong, left, v);
  s.gone = pc_select3(strong, pc_zero3(), lost);
  s.low = pc_select3(strong, left_low, low);
  return s;
}
