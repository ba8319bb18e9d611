#include "extras.h"

#include "pcphys/write_kernel.h"

namespace pcphys::architectures {
namespace {

PCPHYS_KERNEL(wind_force, (PC_IN(Vec3) displacement_rate, PC_IN(Real) area, PC_INOUT(Vec3) force, PC_PARAM(Vec3) wind),
              {
                Vec3 past = pc_sub(wind, displacement_rate);
                Real push = area * pc_length(past);
                force = pc_madd(force, past, push);
              })

// What stops the two from being further apart than the rope's length by the end of the sub-step; a rope only pulls.
PCPHYS_KERNEL(rope,
              (PC_IN(Vec3) place_a, PC_IN(Vec3) place_b, PC_IN(Real) length, PC_IN(Real) mass_a, PC_IN(Real) mass_b,
               PC_INOUT(Vec3) u_a, PC_INOUT(Vec3) u_b, PC_PARAM(Real) inverse_h),
              {
                Vec3 line = pc_sub(place_b, place_a);
                Real distance = pc_length(line);
                Vec3 along = pc_scale(line, pc_inverse_or_zero(distance));
                Real slack = (length - distance) * inverse_h;
                Real parting = pc_dot(along, pc_sub(u_b, u_a));
                Real impulse = pc_max(parting - slack, PC_REAL(0.0)) * pc_inverse_or_zero(mass_a + mass_b);
                u_a = pc_madd(u_a, along, impulse * mass_a);
                u_b = pc_madd(u_b, along, -(impulse * mass_b));
              })

kernel_f32::Vec3 load(const float* p) { return {p[0], p[1], p[2]}; }
void store(kernel_f32::Vec3 v, float* p) { p[0] = v.x, p[1] = v.y, p[2] = v.z; }

}  // namespace

void wind_drag(const float velocity[3], float area, float force[3], const float wind[3]) {
  kernel_f32::Vec3 pushes(0, 0, 0);
  wind_force::f32::run(load(velocity), area, pushes, load(wind));
  store(pushes, force);
}
KernelText wind_kernel() { return wind_force::text(); }

void hold_rope(const float* pose_a, const float* pose_b, float length, float* motion_a, float* motion_b,
               float inverse_h) {
  kernel_f32::Vec3 u_a = load(motion_a), u_b = load(motion_b);
  rope::f32::run(load(pose_a), load(pose_b), length, motion_a[3], motion_b[3], u_a, u_b, inverse_h);
  store(u_a, motion_a), store(u_b, motion_b);
}

}  // namespace pcphys::architectures
