// The kernels for four lanes of float (SSE4.2).
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR float
#define PC_LANES 4
#define PC_NAMESPACE lanes_f4
#define PC_EXPORT cpu_kernels_f4
#include "cpu/kernels_all.inl"
#endif
