// The narrow phase in double.
#define PC_SCALAR double
#define PC_DOUBLE
#define PC_LANES 1
#define PC_NAMESPACE narrow_d
#include "collision/narrow_all.inl"
