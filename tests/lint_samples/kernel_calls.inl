// Functions that each device rounds in its own way, and text outside the common subset.
PC_FN Real pc_bad(Vec3 v, Real a) {
  Real r = sqrt(a);              // expect: call
  Real d = dot(v, v);            // expect: call
  Vec3 n = normalize(v);         // expect: call
  Real m = min(a, r);            // expect: call
  Real e = std::exp(a);          // expect: call
  Real f = float(a);             // expect: call
  Real u = v.norm();             // expect: call
  Real k = unknown_function(a);  // expect: call
  return pc_sqrt(abs(d));        // expect: call
}
PC_FN Real dot(Real a, Real b) {
  precise Real r = a * b;
  return r;
}
