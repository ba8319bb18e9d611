#include "ballistic_hand.h"

#include <cmath>

namespace ballistic {
namespace {

constexpr std::size_t width = 8;
using Lanes = float[width];

inline float snap(float x) { return std::fabs(x) < 1e-18f ? 0.0f : x; }
/// The rounded sum, and what rounding dropped.
inline void two_sum(float& a, float b, float& low) {
  const float sum = a + b, bb = sum - a, aa = sum - bb, eb = b - bb, ea = a - aa;
  a = sum;
  low = ea + eb;
}

struct Block {
  Lanes u[3], u_low[3], l[3], l_low[3], p[3], p_low[3], q[4], q_low[4], a[3], t[3], u_change[3], l_change[3], inverse;
};

inline void substep(Block& b, float h) {
  for (std::size_t i = 0; i < width; i++) {
    float phi[3];
    for (int k = 0; k < 3; k++) {
      const float u = b.u[k][i], l = b.l[k][i];
      two_sum(b.u[k][i], b.a[k][i] * h + b.u_low[k][i], b.u_low[k][i]);
      two_sum(b.l[k][i], b.t[k][i] * h + b.l_low[k][i], b.l_low[k][i]);
      b.u[k][i] = snap(b.u[k][i]), b.u_low[k][i] = snap(b.u_low[k][i]);
      b.l[k][i] = snap(b.l[k][i]), b.l_low[k][i] = snap(b.l_low[k][i]);
      b.u_change[k][i] = b.u[k][i] - u, b.l_change[k][i] = b.l[k][i] - l;
      two_sum(b.p[k][i], b.p_low[k][i] + b.u[k][i] * h, b.p_low[k][i]);
      b.p_low[k][i] = snap(b.p_low[k][i]);
      phi[k] = snap(b.l[k][i] * (b.inverse[i] * h));
    }
    // the turn: exp(phi / 2) - 1
    const float angle = std::sqrt(phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2]);
    const float inverse_angle = angle > 0 ? 1 / angle : 0, r = angle * 0.5f, z = r * r;
    const float s0 = (8.3321608736e-3f - 1.9515295891e-4f * z) * z - 1.6666654611e-1f;
    const float c0 = (2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f;
    const float sine = r + r * z * s0, fall = z * z * c0 - 0.5f * z;
    const float x = phi[0] * inverse_angle * sine, y = phi[1] * inverse_angle * sine, w = phi[2] * inverse_angle * sine;
    const float qx = b.q[0][i], qy = b.q[1][i], qz = b.q[2][i], qw = b.q[3][i];
    const float change[4] = {qx * fall + x * qw + (y * qz - w * qy), qy * fall + y * qw + (w * qx - x * qz),
                             qz * fall + w * qw + (x * qy - y * qx), fall * qw - x * qx - y * qy - w * qz};
    const float off = 1 - (qx * qx + qy * qy + qz * qz + qw * qw);
    const float rest = qx * b.q_low[0][i] + qy * b.q_low[1][i] + qz * b.q_low[2][i] + qw * b.q_low[3][i];
    const float size = std::fabs(change[0]) + std::fabs(change[1]) + std::fabs(change[2]) + std::fabs(change[3]);
    const float lack = size > 0 ? off * 0.5f - rest : 0;
    for (int k = 0; k < 4; k++) {
      const float by = (b.q_low[k][i] + (b.q[k][i] + change[k]) * lack) + change[k];
      two_sum(b.q[k][i], by, b.q_low[k][i]);
      b.q_low[k][i] = snap(b.q_low[k][i]);
    }
  }
}

}  // namespace

void step(Arrays& arrays) {
  for (std::size_t first = 1; first + width <= arrays.bodies + 1; first += width) {
    Block b;
    float *motion = &arrays.motion[first * 8], *pose = &arrays.pose[first * 16],
          *parts = &arrays.velocity_parts[first * 16];
    const float *mass = &arrays.mass[first * 8], *force = &arrays.force[first * 8];
    for (std::size_t i = 0; i < width; i++) {
      for (std::size_t k = 0; k < 3; k++) {
        b.u[k][i] = motion[i * 8 + k], b.l[k][i] = motion[i * 8 + 4 + k];
        b.u_low[k][i] = parts[i * 16 + 8 + k], b.l_low[k][i] = parts[i * 16 + 12 + k];
        b.p[k][i] = pose[i * 16 + k], b.p_low[k][i] = pose[i * 16 + 8 + k];
        b.a[k][i] = arrays.gravity[k] + force[i * 8 + k] * motion[i * 8 + 3];
        b.t[k][i] = force[i * 8 + 4 + k];
      }
      for (std::size_t k = 0; k < 4; k++) b.q[k][i] = pose[i * 16 + 4 + k], b.q_low[k][i] = pose[i * 16 + 12 + k];
      b.inverse[i] = mass[i * 8 + 4];
    }
    for (int k = 0; k < arrays.substeps; k++) substep(b, arrays.h);
    for (std::size_t i = 0; i < width; i++) {
      for (std::size_t k = 0; k < 3; k++) {
        motion[i * 8 + k] = b.u[k][i], motion[i * 8 + 4 + k] = b.l[k][i];
        parts[i * 16 + k] = snap(b.u_change[k][i] * 0.5f), parts[i * 16 + 4 + k] = snap(b.l_change[k][i] * 0.5f);
        parts[i * 16 + 8 + k] = b.u_low[k][i], parts[i * 16 + 12 + k] = b.l_low[k][i];
        pose[i * 16 + k] = b.p[k][i], pose[i * 16 + 8 + k] = b.p_low[k][i];
      }
      for (std::size_t k = 0; k < 4; k++) pose[i * 16 + 4 + k] = b.q[k][i], pose[i * 16 + 12 + k] = b.q_low[k][i];
    }
  }
}

const char* shader() {
  return R"(#version 430
layout(local_size_x = 64) in;
layout(std430, binding = 0) restrict buffer Motion { vec4 motion[]; };
layout(std430, binding = 1) restrict buffer Pose { vec4 pose[]; };
layout(std430, binding = 2) restrict buffer Parts { vec4 parts[]; };
layout(std430, binding = 3) restrict readonly buffer Mass { vec4 mass[]; };
layout(std430, binding = 4) restrict readonly buffer Force { vec4 force[]; };
uniform vec4 gravity_h;
uniform uvec2 bodies_substeps;
vec4 snap(vec4 x) { return mix(x, vec4(0.0), lessThan(abs(x), vec4(1e-18))); }
void two_sum(inout vec4 a, vec4 b, out vec4 low) {
  precise vec4 sum = a + b;
  precise vec4 bb = sum - a;
  precise vec4 aa = sum - bb;
  precise vec4 eb = b - bb;
  precise vec4 ea = a - aa;
  precise vec4 e = ea + eb;
  a = sum;
  low = snap(e);
}
void main() {
  uint i = gl_GlobalInvocationID.x + 1u;
  if (i > bodies_substeps.x) return;
  vec4 u = motion[2u * i], l = motion[2u * i + 1u], u_low = parts[4u * i + 2u], l_low = parts[4u * i + 3u];
  vec4 p = pose[4u * i], q = pose[4u * i + 1u], p_low = pose[4u * i + 2u], q_low = pose[4u * i + 3u];
  vec4 push = force[2u * i], turn = force[2u * i + 1u];
  float inverse = mass[2u * i + 1u].x, inverse_mass = u.w, settling = l_low.w, h = gravity_h.w;
  vec4 a = vec4(gravity_h.xyz + push.xyz * inverse_mass, 0.0), t = vec4(turn.xyz, 0.0), u_before, l_before;
  u.w = l.w = p.w = u_low.w = l_low.w = p_low.w = 0.0;
  for (uint k = 0u; k < bodies_substeps.y; k++) {
    u_before = u; l_before = l;
    two_sum(u, a * h + u_low, u_low);
    two_sum(l, t * h + l_low, l_low);
    two_sum(p, p_low + u * h, p_low);
    vec3 phi = l.xyz * (inverse * h);
    float angle = length(phi), r = angle * 0.5, z = r * r;
    float s0 = (8.3321608736e-3 - 1.9515295891e-4 * z) * z - 1.6666654611e-1;
    float c0 = (2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2;
    vec3 v = angle > 0.0 ? phi * ((r + r * z * s0) / angle) : vec3(0.0);
    float fall = z * z * c0 - 0.5 * z;
    vec4 change = vec4(q.xyz * fall + v * q.w + cross(v, q.xyz), fall * q.w - dot(v, q.xyz));
    float lack = dot(abs(change), vec4(1.0)) > 0.0 ? (1.0 - dot(q, q)) * 0.5 - dot(q, q_low) : 0.0;
    two_sum(q, (q_low + (q + change) * lack) + change, q_low);
  }
  parts[4u * i] = vec4((u - u_before).xyz * 0.5, 0.0); parts[4u * i + 1u] = vec4((l - l_before).xyz * 0.5, 0.0);
  parts[4u * i + 2u] = u_low; parts[4u * i + 3u] = vec4(l_low.xyz, settling);
  motion[2u * i] = vec4(u.xyz, inverse_mass); motion[2u * i + 1u] = l;
  pose[4u * i] = p; pose[4u * i + 1u] = q; pose[4u * i + 2u] = p_low; pose[4u * i + 3u] = q_low;
}
)";
}

}  // namespace ballistic
