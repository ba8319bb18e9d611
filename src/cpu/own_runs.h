// Kernels of the host's own on the CPU: of rows, of pairs, of joints with their bodies, and of all rows to one value.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "cpu/workers.h"
#include "step/backend.h"
#include "world/memory.h"

namespace pcphys {

class OwnRuns {
 public:
  /// `buffers`: where they stand, by Buffer; `info`: the block of the run.
  void run(const KernelRun& run, std::span<void* const> buffers, const std::byte* info, const Workers* workers);

  std::size_t sum_bytes() const { return sums_.capacity(); }

 private:
  /// Where the arguments of a run stand.
  struct Columns {
    std::array<std::byte*, OwnKernel::most_arguments> at{}, totals{};
    std::array<std::size_t, OwnKernel::most_arguments> strides{};
  };
  static Columns columns(const OwnKernel& kernel, std::span<void* const> buffers, const std::byte* info);
  /// Room for a value of each sum of so many rows.
  void reserve(const OwnKernel& kernel, std::size_t rows, Columns& columns);
  /// The same columns with room for a term of each row, all zero, in place of what is summed.
  Columns terms(const OwnKernel& kernel, std::size_t rows, const Columns& columns);
  void join(const KernelRun& run, std::span<void* const> buffers, Columns& columns, const Workers* workers);
  void pairs(const KernelRun& run, std::span<void* const> buffers, Columns& columns, const Workers* workers);
  void reduce(const KernelRun& run, std::span<void* const> buffers, Columns& columns, const Workers* workers);

  AlignedBytes sums_;
};

}  // namespace pcphys
