// Names that C++ allows and GLSL does not.
PC_FN Real pc_reserved(Real a) {
  Real common = a;  // expect: reserved
  Real filter = a;  // expect: reserved
  return pc_max(common, filter);
}
