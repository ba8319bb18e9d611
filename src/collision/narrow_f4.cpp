// The narrow phase of many pairs, four lanes of float (SSE4.2).
#ifdef PCPHYS_HAVE_X86_LANES
#define PC_SCALAR float
#define PC_LANES 4
#define PC_NAMESPACE narrow_f4
#define PC_EXPORT narrow_lanes_f4
#include "collision/narrow_lanes.inl"
#endif
