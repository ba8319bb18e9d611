// The narrow phase of many pairs, one by one, double.
#define PC_SCALAR double
#define PC_DOUBLE
#define PC_LANES 1
#define PC_NAMESPACE narrow_d1
#define PC_EXPORT narrow_lanes_d1
#include "collision/narrow_lanes.inl"
