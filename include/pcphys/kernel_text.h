// The text of kernels as C++: Real, Vec3, Quad, Quaternion, Sym3, Mat3 and the functions pc_* of kernel_math.inl, for
// one element, in float (pcphys::kernel_f32) and in double (pcphys::kernel_f64). The same text is GLSL on the GPU. What
// makes both agree to the bit: no operator / and no functions of the language's own, but pc_div, pc_sqrt and so on;
// constants as PC_REAL(0.5); no contraction (pcphys_add_kernel in CMake, or -ffp-contract=off).
#pragma once
#include <cmath>
#include <cstdint>

#define PC_FN static inline
#define PC_INOUT(T) T&
#define PC_IN(T) const T
#define PC_OUT(T) T&
#define PC_PARAM(T) const T
#define PC_SELF(T) const T
#define PC_OTHER(T) const T
#define PC_A(T) const T
#define PC_B(T) const T
#define PC_SUM(T) T&
#define PC_ADD(T) T&
#define PC_ADD_A(T) T&
#define PC_ADD_B(T) T&
#define PC_MIN(T) T&
#define PC_MAX(T) T&
#define PC_REAL(x) Real(x)
#define PC_ANY(mask) (mask)
#define precise

#define PC_SCALAR float
namespace pcphys::kernel_f32 {
#include "pcphys/kernel_scalar.inl"
}
#undef PC_SCALAR
#define PC_SCALAR double
#define PC_DOUBLE
namespace pcphys::kernel_f64 {
#include "pcphys/kernel_scalar.inl"
}
#undef PC_DOUBLE
#undef PC_SCALAR
