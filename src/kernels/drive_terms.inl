// Springs and dampers of motors and joints as rows: an impulse P = -(push + gamma u'),
// u' the velocity that the solve finds.
//
// With k the stiffness, c the damping, x how far from rest, u the velocity of the last sub-step,
// m the inertia that the row feels:
//   P = -h k (x + beta h u') - h c (u + u' + sigma (u' - u)) / 2,
//   beta = s^2 / (1 + s^2), s = h^2 k / m,   sigma likewise of h c / m
// Where the sub-step resolves the spring this is the leapfrog with a trapezoidal damper, of second order; where it does
// not it is the implicit Euler method, which takes energy out at any stiffness. Stable for all s, since
// s (1 - 2 beta) < 4. `kick` is h; h / 2 in the first sub-step after a velocity was set, since stored velocities lag
// half a sub-step.
struct DriveRow {
  Real gamma;
  Real push;
};

// `answer`: 1 / m.
PC_FN DriveRow pc_drive_row(Real h, Real kick, Real stiffness, Real damping, Real away, Real last, Real answer) {
  precise Real kh = stiffness * kick;
  precise Real ch = damping * kick;
  precise Real khh = kh * h;
  precise Real s = khh * answer;
  precise Real y = ch * answer;
  Real beta = pc_unresolved(s);
  Real sigma = pc_unresolved(y);
  precise Real late = PC_REAL(0.5) + PC_REAL(0.5) * sigma;
  precise Real early = PC_REAL(0.5) - PC_REAL(0.5) * sigma;
  precise Real gamma = khh * beta + ch * late;
  precise Real push = kh * away + ch * early * last;
  DriveRow r;
  r.gamma = pc_snap(gamma);
  r.push = pc_snap(push);
  return r;
}

// The axes of a's joint frame in the world, and the rotation vector from the orientation of rest to b's, along them.
struct DriveFrame {
  Vec3 x;
  Vec3 y;
  Vec3 z;
  Vec3 away;
};
PC_FN DriveFrame pc_drive_frame(Quaternion fa, Quaternion fb, Quaternion rest) {
  Quaternion q = pc_quaternion_mul(pc_quaternion_mul(pc_conjugate(fa), fb), pc_conjugate(rest));
  Real flip = pc_select(q.w < PC_REAL(0.0), PC_REAL(-1.0), PC_REAL(1.0));
  Vec3 v = pc_scale(q.v, flip);
  precise Real w = q.w * flip;
  Real size = pc_length(v);
  precise Real angle = pc_angle(size, w) * PC_REAL(2.0);
  Real rate = pc_select(size > PC_SLIGHT, pc_div(angle, pc_max(size, PC_TINY)), PC_REAL(2.0));
  DriveFrame d;
  d.x = pc_rotate(fa, Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0)));
  d.y = pc_rotate(fa, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)));
  d.z = pc_cross(d.x, d.y);
  d.away = pc_scale(v, rate);
  return d;
}
