// The narrow phase of many pairs, four lanes of double (AVX2, no fused multiply-add).
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR double
#define PC_DOUBLE
#define PC_LANES 4
#define PC_NAMESPACE narrow_d4
#define PC_EXPORT narrow_lanes_d4
#include "collision/narrow_lanes.inl"
#endif
