// The kernels for one lane of float: the scalar reference.
#define PC_SCALAR float
#define PC_LANES 1
#define PC_NAMESPACE lanes_f1
#define PC_EXPORT cpu_kernels_f1
#include "cpu/kernels_all.inl"
