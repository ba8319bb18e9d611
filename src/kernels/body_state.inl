// A body as the constraint kernels see it: velocity, world angular momentum, inverse inertia of this sub-step.
struct BodyState {
  Vec3 v;
  Real inverse_mass;
  Vec3 l;
  Real phase;
  Sym3 inertia;
  Real response;
  Real unlike;
};

PC_FN BodyState pc_body_state(PC_IO Index i) {
  Quad linear = PC_GATHER(motion, i, 0u);
  Quad angular = PC_GATHER(motion, i, 1u);
  Quad i0 = PC_GATHER(inertia, i, 0u);
  Quad i1 = PC_GATHER(inertia, i, 1u);
  BodyState b;
  b.v = linear.v;
  b.inverse_mass = linear.s;
  b.l = angular.v;
  b.phase = angular.s;
  b.inertia.xx = i0.v.x;
  b.inertia.xy = i0.v.y;
  b.inertia.xz = i0.v.z;
  b.inertia.yy = i0.s;
  b.inertia.yz = i1.v.x;
  b.inertia.zz = i1.v.y;
  b.response = i1.v.z;
  b.unlike = i1.s;
  return b;
}
// How it answers a couple: the inverse inertia, zero of what does not answer.
PC_FN Sym3 pc_responding_inertia(BodyState b) { return pc_sym_scale(b.inertia, b.response); }
// What answers impulses at an arm by turning: the sum over three axes.
PC_FN Real pc_turning_answer(BodyState b, Vec3 arm) {
  precise Real trace = b.inertia.xx + b.inertia.yy + b.inertia.zz;
  precise Real answer = (trace * pc_dot(arm, arm) - pc_dot(arm, pc_sym_mul(b.inertia, arm))) * b.response;
  return answer;
}
PC_FN Vec3 pc_angular_velocity(BodyState b) { return pc_sym_mul(b.inertia, b.l); }
