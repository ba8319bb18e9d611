// An orientation, as a sum of two reals, after a sub-step that changed it: what does not turn keeps its bits.
// Half of what the square of the length of q + low lacks of 1: the step of Newton's method towards a unit quaternion.
PC_FN Real pc_lack_of_unit(Quaternion q, Quad low) {
  precise Real lack = PC_REAL(1.0) - (q.v.x * q.v.x + q.v.y * q.v.y + q.v.z * q.v.z + q.w * q.w);
  precise Real rest = q.v.x * low.v.x + q.v.y * low.v.y + q.v.z * low.v.z + q.w * low.s;
  precise Real r = lack * PC_REAL(0.5) - rest;
  return r;
}
PC_FN Mask pc_turns(Quaternion change) {
  precise Real size = pc_abs(change.v.x) + pc_abs(change.v.y) + pc_abs(change.v.z) + pc_abs(change.w);
  return size > PC_REAL(0.0);
}
struct Turned {
  Quad q;
  Quad low;
};
// The same orientation with the length of 1 that the next turn would give it.
PC_FN Turned pc_righted(Turned t) {
  Quaternion q = pc_quaternion(t.q.v, t.q.s);
  Real lack = pc_lack_of_unit(q, t.low);
  precise Vec3 change_v = t.low.v + q.v * lack;
  precise Real change_w = t.low.s + q.w * lack;
  TwoSum v = pc_two_sum(q.v, change_v);
  precise Real w = q.w + change_w;
  Turned r;
  r.q = pc_quad(v.sum, w);
  r.low = pc_quad(pc_snap3(v.low), pc_snap(pc_two_sum_error(q.w, change_w, w)));
  return r;
}
PC_FN Turned pc_turned(Quaternion q, Quad turned_low, Quaternion change) {
  Real lack = pc_select(pc_turns(change), pc_lack_of_unit(q, turned_low), PC_REAL(0.0));
  // the correction of length is along the turned quaternion:
  // along the old one it would grow what turns by half a circle
  precise Vec3 change_v = (turned_low.v + (q.v + change.v) * lack) + change.v;
  precise Real change_w = (turned_low.s + (q.w + change.w) * lack) + change.w;
  TwoSum v = pc_two_sum(q.v, change_v);
  precise Real w = q.w + change_w;
  Turned r;
  r.q = pc_quad(v.sum, w);
  r.low = pc_quad(pc_snap3(v.low), pc_snap(pc_two_sum_error(q.w, change_w, w)));
  return r;
}
