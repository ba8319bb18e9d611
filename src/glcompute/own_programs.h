// Kernels of the host's own on the GPU: their programs, and the runs of those that are two programs each
// (own_source.cpp). The context must be current.
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
  /// Of all other forms: both programs, with the barriers before and between them.
  Status run_in_two(const KernelRun& run, GlMemory& memory);

  std::size_t sum_bytes() const { return sums_.capacity(); }

 private:
  const OwnProgram& of(const OwnKernel& kernel) const { return programs_.at(kernel.serial); }
  /// `values`: how many of each sum stand between the two.
  template <class First, class Second>
  Status run_in_two(const KernelRun& run, std::size_t values, GlMemory& memory, First first, Second second);
  void bind_sums(std::span<const Access> beside) const;

  std::unordered_map<std::uint64_t, OwnProgram> programs_;  // by serial
  GlBuffer sums_;                                           // between two programs
};

}  // namespace pcphys
