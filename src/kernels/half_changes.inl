// Half of what the last sub-step changed in the velocities, so that u + half change is the
// velocity in phase with the position, to second order. Where a contact touched a body and the change is more than
// twice what forces alone would have made of it, half of theirs: an impact is no acceleration, and before and after it
// the body falls. At rest that is zero to the rounding of the impulses that hold it; what is no larger reads zero.
// The first sub-step after a velocity was set has half a kick, and so half of what constraints answer: there all of
// that is due again. With drag (PC_DRAG) forces and drag bring it into phase exactly, as in begin.inl, whatever F h is:
//   h (phi - phi2) / phi (a - F u) + half of what constraints changed.
// What blows is no acceleration: where `blown`, forces alone are.
PC_FN Real pc_share_due(Mask first) { return pc_select(first, PC_REAL(1.0), PC_REAL(0.5)); }
PC_FN Vec3 pc_plain_change(PC_IO Mask first, Mask blown, Vec3 now, Vec3 before, Vec3 a) {
  precise Real half_time = PC_INFO(h) * PC_REAL(0.5);
  precise Vec3 change = now - before;
  precise Vec3 all = change - a * half_time;
  precise Vec3 half_of_it = change * PC_REAL(0.5);
  return pc_select3(blown, pc_scale(a, half_time), pc_select3(first, all, half_of_it));
}
#ifdef PC_DRAG
PC_FN Vec3 pc_half_change(PC_IO Mask first, Mask blown, Vec3 now, Vec3 before, Vec3 a, Real drag, Decay d) {
  Real h = PC_INFO(h);
  precise Real x = drag * h;
  Share s = pc_share(x, before, pc_zero3(), d);
  precise Real kick = d.phi * h;
  precise Vec3 change = a * kick - s.gone;
  precise Vec3 constraints = ((now - s.kept) - change) * pc_select(blown, PC_REAL(0.0), pc_share_due(first));
  precise Real gap = d.phi - d.phi2;
  precise Real time = pc_div(gap, d.phi) * h;
  precise Vec3 exact = (a - now * drag) * time + constraints;
  Vec3 plain = pc_plain_change(PC_PASS first, blown, now, before, a);
  return pc_select3(drag > PC_REAL(0.0), exact, plain);
}
#endif
PC_FN Mask pc_exceeds(Vec3 x, Real limit) { return pc_max(pc_abs(x.x), pc_max(pc_abs(x.y), pc_abs(x.z))) > limit; }

struct HalfChanges {
  Vec3 u;
  Vec3 l;
};
PC_FN HalfChanges pc_half_changes(PC_IO Quad linear, Quad angular, Quad linear_before, Quad angular_before,
                                  Quad moments, BodyForce f) {
  Mask touched = angular.s > PC_REAL(0.0);
  Vec3 gravity = Vec3(PC_INFO(gravity_x), PC_INFO(gravity_y), PC_INFO(gravity_z));
  Vec3 acceleration = pc_madd(gravity, f.push.v, linear.s);
  Vec3 change = pc_sub(linear.v, linear_before.v);
  precise Real most = PC_INFO(h) * PC_REAL(2.0);
  Vec3 forced = pc_scale(acceleration, most);
  Mask glides = pc_dot(change, change) < pc_dot(forced, forced);
  Mask first = angular_before.s < PC_REAL(0.0);
  Mask blown = pc_and(touched, pc_select(glides, PC_REAL(0.0), PC_REAL(1.0)) > PC_REAL(0.5));
#ifdef PC_DRAG
  Mask dynamic_body = linear.s > PC_REAL(0.0);
  Vec3 u = pc_select3(dynamic_body,
                      pc_half_change(PC_PASS first, blown, linear.v, linear_before.v, acceleration, f.push.s, f.slow),
                      pc_zero3());
  Vec3 l = pc_select3(dynamic_body,
                      pc_half_change(PC_PASS first, blown, angular.v, angular_before.v, f.turn.v, f.turn.s, f.calm),
                      pc_zero3());
#else
  Vec3 u = pc_plain_change(PC_PASS first, blown, linear.v, linear_before.v, acceleration);
  Vec3 l = pc_plain_change(PC_PASS first, blown, angular.v, angular_before.v, f.turn.v);
#endif
  precise Real noise = angular.s * PC_INFO(rounding);
  precise Real speed = noise * linear.s;
  precise Real square = pc_max(moments.v.x, pc_max(moments.v.y, moments.v.z)) * linear.s;
  precise Real spin = noise * pc_sqrt(square);

  Vec3 held_u = pc_select3(pc_exceeds(linear.v, speed), u, pc_negate(linear.v));
  Vec3 held_l = pc_select3(pc_exceeds(angular.v, spin), l, pc_negate(angular.v));
  HalfChanges c;
  c.u = pc_snap3(pc_select3(touched, held_u, u));
  c.l = pc_snap3(pc_select3(touched, held_l, l));
  return c;
}
