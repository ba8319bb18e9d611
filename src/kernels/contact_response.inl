// Impulse F at the manifold's centre and couple M act on b, their opposites on a. Momentum is what is
// stored, so both momenta are conserved to rounding: the arms end in one common point (see pc_arms).
#include "body_push.inl"
#include "contact_arms.inl"
#include "contact_twist.inl"

PC_FN void pc_apply(PC_IO Index ia, Index ib, PC_INOUT(BodyState) a, PC_INOUT(BodyState) b, Arms arms, Vec3 impulse, Vec3 couple) {
  Vec3 torque_a = pc_add(couple, pc_cross(arms.a, impulse)); Vec3 torque_b = pc_add(couple, pc_cross(arms.b, impulse));
  precise Real minus_mass = -a.inverse_mass; precise Real minus_response = -a.response;
  a.v = pc_pushed(a.v, impulse, minus_mass); b.v = pc_pushed(b.v, impulse, b.inverse_mass);
  a.l = pc_madd(a.l, torque_a, minus_response); b.l = pc_madd(b.l, torque_b, b.response);
  pc_store_states(PC_PASS ia, ib, a, b);
}
// Sum of four normal impulses as an impulse along n and a couple in the contact plane.
struct Push { Real n; Real m1; Real m2; };
PC_FN Push pc_push(PC_IO Slot m, Real l0, Real l1, Real l2, Real l3) {
  precise Real n = l0 + l1 + l2 + l3;
  precise Real m1 = PC_LD(contact_rows, m, ROW_B) * l0 + PC_LD(contact_rows, m, ROW_B + 1u) * l1 + PC_LD(contact_rows, m, ROW_B + 2u) * l2 + PC_LD(contact_rows, m, ROW_B + 3u) * l3;
  precise Real m2 = PC_LD(contact_rows, m, ROW_A) * l0 + PC_LD(contact_rows, m, ROW_A + 1u) * l1 + PC_LD(contact_rows, m, ROW_A + 2u) * l2 + PC_LD(contact_rows, m, ROW_A + 3u) * l3;
  Push p; p.n = n; p.m1 = m1; p.m2 = -m2; return p;
}
