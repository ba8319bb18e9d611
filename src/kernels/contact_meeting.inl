#include "contact_carried.inl"
// How the sides of a contact move against each other, without what is pending in trees.
// Needs contact_arms.inl, contact_twist.inl, contact_shift.inl.
struct Meeting {
  BodyState a;
  BodyState b;
  Arms arms;
  Shift shift;
  Twist twist;
};
PC_FN Meeting pc_meeting(PC_IO Slot m, Index ia, Index ib, Vec3 n, Vec3 t1, Vec3 t2) {
  Quad moved_a = PC_GATHER(delta, ia, 0u);
  Quad moved_b = PC_GATHER(delta, ib, 0u);
  Meeting r;
  r.shift = pc_shift_of(PC_PASS m, n, t1, t2, moved_a, moved_b, PC_GATHER(delta, ia, 1u), PC_GATHER(delta, ib, 1u));
  r.arms = pc_arms(PC_PASS m, moved_a.v, moved_b.v);
  r.a = pc_body_state(PC_PASS ia);
  r.b = pc_body_state(PC_PASS ib);
  r.twist = pc_carried(PC_PASS pc_twist(r.a, r.b, r.arms, n, t1, t2), r.a, r.b, r.arms, t1, t2);
  return r;
}
