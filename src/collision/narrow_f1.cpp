// The narrow phase of many pairs, one by one, float.
#define PC_SCALAR float
#define PC_LANES 1
#define PC_NAMESPACE narrow_f1
#define PC_EXPORT narrow_lanes_f1
#include "collision/narrow_lanes.inl"
