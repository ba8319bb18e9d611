// How two free bodies answer impulses at their arms ra and rb, in the contact frame.
PC_FN Responses pc_free_responses(BodyState a, BodyState b, Vec3 ra, Vec3 rb, Vec3 n, Vec3 t1, Vec3 t2) {
  Sym3 inertia_a = pc_responding_inertia(a);
  Sym3 inertia_b = pc_responding_inertia(b);
  precise Real k = a.inverse_mass + b.inverse_mass;
  // angular parts of unit impulses t1, t2, n at the centre
  Vec3 ga1 = pc_cross(ra, t1);
  Vec3 ga2 = pc_cross(ra, t2);
  Vec3 gan = pc_cross(ra, n);
  Vec3 gb1 = pc_cross(rb, t1);
  Vec3 gb2 = pc_cross(rb, t2);
  Vec3 gbn = pc_cross(rb, n);
  Vec3 ha1 = pc_sym_mul(inertia_a, ga1);
  Vec3 ha2 = pc_sym_mul(inertia_a, ga2);
  Vec3 han = pc_sym_mul(inertia_a, gan);
  Vec3 hb1 = pc_sym_mul(inertia_b, gb1);
  Vec3 hb2 = pc_sym_mul(inertia_b, gb2);
  Vec3 hbn = pc_sym_mul(inertia_b, gbn);
  Sym3 both = pc_sym_add(inertia_a, inertia_b);
  Vec3 i1 = pc_sym_mul(both, t1);
  Vec3 i2 = pc_sym_mul(both, t2);
  Vec3 in_ = pc_sym_mul(both, n);
  Vec3 h1 = pc_add(ha1, hb1);
  Vec3 h2 = pc_add(ha2, hb2);
  Vec3 hn = pc_add(han, hbn);

  // responses in the contact frame: of the centre's velocity to impulses, of the turning to impulses,
  // of the turning to couples
  precise Real k11 = k + pc_dot(ga1, ha1) + pc_dot(gb1, hb1);
  precise Real k12 = pc_dot(ga1, ha2) + pc_dot(gb1, hb2);
  precise Real k22 = k + pc_dot(ga2, ha2) + pc_dot(gb2, hb2);
  precise Real cn1 = pc_dot(gan, ha1) + pc_dot(gbn, hb1);
  precise Real cn2 = pc_dot(gan, ha2) + pc_dot(gbn, hb2);
  precise Real nn = k + pc_dot(gan, han) + pc_dot(gbn, hbn);
  Responses r;
  r.l.xx = k11;
  r.l.xy = k12;
  r.l.xz = cn1;
  r.l.yy = k22;
  r.l.yz = cn2;
  r.l.zz = nn;
  r.w1 = Vec3(pc_dot(t1, h1), pc_dot(t1, h2), pc_dot(t1, hn));
  r.w2 = Vec3(pc_dot(t2, h1), pc_dot(t2, h2), pc_dot(t2, hn));
  r.wn = Vec3(pc_dot(n, h1), pc_dot(n, h2), pc_dot(n, hn));
  r.a.xx = pc_dot(t1, i1);
  r.a.xy = pc_dot(t1, i2);
  r.a.xz = pc_dot(t1, in_);
  r.a.yy = pc_dot(t2, i2);
  r.a.yz = pc_dot(t2, in_);
  r.a.zz = pc_dot(n, in_);
  return r;
}
