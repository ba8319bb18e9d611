// Compiled programs, and the proof that they see buffers as C++ lays them out.
#pragma once
#include <cstdint>
#include <string>

#include "glcompute/program_cache.h"
#include "glcompute/program_source.h"

namespace pcphys {

/// A linked program from the cache or the compiler; `label` names it in errors. The caller deletes it.
Result<std::uint32_t> link_program(const ProgramSource& source, const std::string& label, const ProgramCache& cache);

/// Compares bindings, offsets, types and strides as GL reports them with the schema.
/// device_error, naming buffer, what was expected and what was found.
Status check_layout(std::uint32_t program, Kernel kernel, Precision precision);

struct KernelProgram {
  std::uint32_t id = 0;
  std::int32_t range = -1;  // location of the uniform pc_range
};
/// Of a kernel of the host's own: one program, or two of pairs and reductions.
struct OwnProgram {
  std::uint32_t id = 0;
  std::int32_t range = -1, work = -1, cutoff_squared = -1;  // locations; see own_source.cpp
  // location of each component of each argument in turn; -1: not used, or no parameter
  std::vector<std::int32_t> parameters;
  struct Totals {
    std::uint32_t id = 0;
    std::int32_t range = -1, work = -1;
  } totals;
};
Result<OwnProgram> load_kernel(const OwnKernel& kernel, const SourceOptions& options, const ProgramCache& cache);
Result<KernelProgram> load_kernel(Kernel kernel, const SourceOptions& options, const ProgramCache& cache);

/// Runs the program that is bound over [begin, end), in pieces of as many work groups as the device takes; pieces need
/// no barrier. `range_location`: of its pc_range; `rows`: work groups in the second dimension;
/// `each`: how many a work group does.
void dispatch(std::int32_t range_location, std::uint32_t begin, std::uint32_t end, const GlLimits& limits,
              std::uint32_t rows = 1, std::uint32_t each = gl_work_group);

}  // namespace pcphys
