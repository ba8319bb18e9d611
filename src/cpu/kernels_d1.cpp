// The kernels for one lane of double.
#define PC_SCALAR double
#define PC_LANES 1
#define PC_NAMESPACE lanes_d1
#define PC_EXPORT cpu_kernels_d1
#define PC_DOUBLE
#include "cpu/kernels_all.inl"
