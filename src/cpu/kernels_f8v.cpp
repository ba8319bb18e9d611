// The kernels for eight lanes of float with AVX-512VL: twice the registers,
// and masks of their own (no fused multiply-add).
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR float
#define PC_LANES 8
#define PC_NAMESPACE lanes_f8v
#define PC_EXPORT cpu_kernels_f8v
#include "cpu/kernels_all.inl"
#endif
