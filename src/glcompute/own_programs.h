// Kernels of the host's own on the GPU: their programs, and the runs of those that are two programs each (own_source.cpp). The
// context must be current.
#pragma once
#include <cstdint>
#include <span>
#include <unordered_map>

#include "glcompute/gl_memory.h"
#include "glcompute/program.h"
#include "step/backend.h"

namespace pcphys {

class OwnPrograms {
 public:
  /// Compiles a kernel, unless it is there.
  Status prepare(const OwnKernel& kernel, const SourceOptions& options, const ProgramCache& cache);
  void release();

  /// Of one row: what it needs to run; where its program has pc_range.
  Result<std::int32_t> bind(const OwnKernel& kernel, std::size_t info, GlMemory& memory) const;
  /// Of pairs, or all rows to one value: both programs, with the barriers before and between them.
  Status run_in_two(const KernelRun& run, GlMemory& memory);

 private:
  const OwnProgram& of(const OwnKernel& kernel) const { return programs_.at(kernel.serial); }
  Status run_in_two(const KernelRun& run, const Range& range, GlMemory& memory);
  Status bind_with_sums(const OwnKernel& kernel, std::span<const Buffer> buffers, GlMemory& memory) const;

  std::unordered_map<std::uint64_t, OwnProgram> programs_;  // by serial
  GlBuffer sums_;                                           // between two programs
};

}  // namespace pcphys
