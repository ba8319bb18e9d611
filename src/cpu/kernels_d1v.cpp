// The kernels for one lane of double with AVX-512VL (see kernels_f1v.cpp).
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR double
#define PC_LANES 1
#define PC_NAMESPACE lanes_d1v
#define PC_EXPORT cpu_kernels_d1v
#define PC_DOUBLE
#include "cpu/kernels_all.inl"
#endif
