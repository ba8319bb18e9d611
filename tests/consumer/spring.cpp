// A user kernel: compiled through pcphys_add_kernel, hence without contraction. Were the product fused with
// the sum, the last digit would differ from what the GPU computes.
#include <pcphys/write_kernel.h>

// Refuses to compile under fused multiply-adds, but for what pcphys_add_kernel sets.
PCPHYS_KERNEL(stretched, (PC_IN(Real) mass, PC_INOUT(Real) pull), { pull = pull * mass + mass; })

float spring(float stiffness, float stretch, float rest) { return stiffness * stretch + rest; }
