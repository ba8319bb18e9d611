// The kernels for one lane of float with AVX-512VL: three operands and 32 registers (no fused multiply-add),
// for what stands alone.
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR float
#define PC_LANES 1
#define PC_NAMESPACE lanes_f1v
#define PC_EXPORT cpu_kernels_f1v
#include "cpu/kernels_all.inl"
#endif
