// The kernels for eight lanes of float (AVX2, no fused multiply-add).
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR float
#define PC_LANES 8
#define PC_NAMESPACE lanes_f8
#define PC_EXPORT cpu_kernels_f8
#include "cpu/kernels_all.inl"
#endif
