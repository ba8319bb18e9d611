// What the text of a kernel means in C++ for one element of PC_SCALAR (float or double);
// included by kernel_text.h in a namespace.
using uint = std::uint32_t;
using Real = PC_SCALAR;
using Mask = bool;
static inline Real pc_select(Mask m, Real a, Real b) { return m ? a : b; }
static inline Mask pc_and(Mask a, Mask b) { return a && b; }
static inline Mask pc_or(Mask a, Mask b) { return a || b; }
static inline Real pc_abs(Real a) { return std::fabs(a); }
static inline Real pc_div(Real a, Real b) { return a / b; }
static inline Real pc_sqrt(Real a) { return std::sqrt(a); }

struct Vec3 {
  Real x, y, z;
  Vec3() = default;
  Vec3(Real a, Real b, Real c) : x(a), y(b), z(c) {}
  friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(Vec3 a, Real s) { return {a.x * s, a.y * s, a.z * s}; }
};

#include "pcphys/kernel_math.inl"

struct Mat3 {
  Vec3 x, y, z;  // rows
};
#undef PC_EPSILON
#undef PC_TINY
#undef PC_LEAST
#undef PC_ROUNDER
