// The narrow phase of many pairs, eight lanes of float (AVX2, no fused multiply-add).
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR float
#define PC_LANES 8
#define PC_NAMESPACE narrow_f8
#define PC_EXPORT narrow_lanes_f8
#include "collision/narrow_lanes.inl"
#endif
