// The compiled kernels: one table per lane count and precision, chosen at run time.
#pragma once
#include <array>
#include <cstdint>

#include "world/schema.h"

namespace pcphys {

/// One run of a kernel over [begin, end): positions in `bodies` for the body domain (whole lanes from begin on; the
/// list is padded with row 0), blocks of slots otherwise.
struct KernelCall {
  void* const* buffers;  // by Buffer
  const void* info;      // Info of the precision
  std::uint32_t begin, end;
};

struct CpuKernels {
  std::uint32_t lanes;
  bool f64;
  std::array<void (*)(const KernelCall&), kernel_count> run;  // by Kernel
};

extern const CpuKernels cpu_kernels_f1, cpu_kernels_d1;
#ifdef PCPHYS_HAVE_X86_LANES
extern const CpuKernels cpu_kernels_f4, cpu_kernels_f8, cpu_kernels_d4;
extern const CpuKernels cpu_kernels_f1v, cpu_kernels_f8v, cpu_kernels_d1v;  // with AVX-512VL

/// Whether the processor has what these are compiled for.
bool has_avx512();
#endif

}  // namespace pcphys
