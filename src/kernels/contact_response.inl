// Impulse F at the manifold's centre and couple M act on b, their opposites on a. Momentum is what is
// stored, so both momenta are conserved to rounding: the arms end in one common point (see pc_arms).
#include "body_push.inl"
#include "contact_arms.inl"
#include "contact_twist.inl"

PC_FN void pc_apply(PC_IO Index ia, Index ib, PC_INOUT(BodyState) a, PC_INOUT(BodyState) b, Arms arms, Vec3 impulse,
                    Vec3 couple) {
  Vec3 torque_a = pc_moment(couple, arms.a, impulse);
  Vec3 torque_b = pc_moment(couple, arms.b, impulse);
  precise Real minus_mass = -a.inverse_mass;
  precise Real minus_response = -a.response;
  a.v = pc_pushed(a.v, impulse, minus_mass);
  b.v = pc_pushed(b.v, impulse, b.inverse_mass);
  a.l = pc_madd(a.l, torque_a, minus_response);
  b.l = pc_madd(b.l, torque_b, b.response);
  pc_store_states(PC_PASS ia, ib, a, b);
}
// Sum of four normal impulses as an impulse along n and a couple in the contact plane.
struct Push {
  Real n;
  Real m1;
  Real m2;
};
PC_FN Push pc_push(PC_IO Slot m, Real l0, Real l1, Real l2, Real l3) {
  precise Real n = l0 + l1 + l2 + l3;
  precise Real m1 = PC_LD(contact_rows, m, ROW_B) * l0 + PC_LD(contact_rows, m, ROW_B + 1u) * l1 +
                    PC_LD(contact_rows, m, ROW_B + 2u) * l2 + PC_LD(contact_rows, m, ROW_B + 3u) * l3;
  precise Real m2 = PC_LD(contact_rows, m, ROW_A) * l0 + PC_LD(contact_rows, m, ROW_A + 1u) * l1 +
                    PC_LD(contact_rows, m, ROW_A + 2u) * l2 + PC_LD(contact_rows, m, ROW_A + 3u) * l3;
  Push p;
  p.n = n;
  p.m1 = m1;
  p.m2 = -m2;
  return p;
}
// The impulse and the couple of normal impulses and of friction along t1, t2 and about n.
struct Wrench {
  Vec3 impulse;
  Vec3 couple;
};
PC_FN Wrench pc_wrench(Vec3 n, Vec3 t1, Vec3 t2, Push push, Real along1, Real along2, Real twist) {
#ifdef PC_FRICTIONLESS
  precise Vec3 couple = t1 * push.m1 + t2 * push.m2;
  Wrench w;
  w.impulse = pc_snap3(pc_scale(n, push.n));
  w.couple = pc_snap3(couple);
  return w;
#else
  Wrench w;
  w.impulse = pc_snap3(pc_combine(t1, along1, t2, along2, n, push.n));
  w.couple = pc_snap3(pc_combine(t1, push.m1, t2, push.m2, n, twist));
  return w;
#endif
}
// The twist after normal impulses: by symmetry the responses of sliding and twist to the normal rows are those of the
// rows to them.
PC_FN Twist pc_pushed_twist(PC_IO Slot m, Twist v, Push push) {
#ifndef PC_FRICTIONLESS
  precise Real v1 = v.v1 + (PC_LD(contact_rows, m, ROW_C) * push.n + PC_LD(contact_rows, m, ROW_C + 3u) * push.m1 +
                            PC_LD(contact_rows, m, ROW_C + 6u) * push.m2);
  precise Real v2 = v.v2 + (PC_LD(contact_rows, m, ROW_C + 1u) * push.n + PC_LD(contact_rows, m, ROW_C + 4u) * push.m1 +
                            PC_LD(contact_rows, m, ROW_C + 7u) * push.m2);
  precise Real wn = v.wn + (PC_LD(contact_rows, m, ROW_C + 2u) * push.n + PC_LD(contact_rows, m, ROW_C + 5u) * push.m1 +
                            PC_LD(contact_rows, m, ROW_C + 8u) * push.m2);
  v.v1 = v1;
  v.v2 = v2;
  v.wn = wn;
#endif
  return v;
}
