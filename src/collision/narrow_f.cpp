// The narrow phase in float.
#define PC_SCALAR float
#define PC_LANES 1
#define PC_NAMESPACE narrow_f
#include "collision/narrow_all.inl"
