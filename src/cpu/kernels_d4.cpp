// The kernels for four lanes of double (AVX2, no fused multiply-add).
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR double
#define PC_LANES 4
#define PC_NAMESPACE lanes_d4
#define PC_EXPORT cpu_kernels_d4
#define PC_DOUBLE
#include "cpu/kernels_all.inl"
#endif
