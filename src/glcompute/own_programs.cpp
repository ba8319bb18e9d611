#include "glcompute/own_programs.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>

#include "world/own_properties.h"

namespace pcphys {
namespace {

/// Values of parameters go with each run: they are few, and may have changed.
void set_parameters(const OwnKernel& kernel, const OwnProgram& program) {
  std::size_t i = 0;
  for (const OwnArgument& a : kernel.arguments)
    for (std::uint32_t c = 0; c < components(a.type); c++) {
      const std::int32_t location = program.parameters[i++];
      if (location < 0) continue;
      const double value = read_number(kernel.parameters.data() + a.place + c * number_bytes(a.type, kernel.real_bytes),
                                       a.type, kernel.real_bytes);
      if (a.type == PropertyType::int32)
        glUniform1i(location, GLint(value));
      else if (a.type == PropertyType::uint32)
        glUniform1ui(location, GLuint(value));
      else if (number_bytes(a.type, kernel.real_bytes) == 4)
        glUniform1f(location, GLfloat(value));
      else
        glUniform1d(location, value);
    }
}

// ---- pairs --------------------------------------------------------------------------------------------
/// In how many goes the others are summed.
std::uint32_t chunks_of(const KernelRun& run) {
  if (run.own->cutoff) return 1;
  const std::uint32_t chunk = pair_chunk(run.others);
  return (run.others + chunk - 1) / chunk;
}
void sum_pairs(const KernelRun& run, const OwnProgram& program, const Range& range, const GlLimits& limits) {
  const OwnKernel& k = *run.own;
  if (k.cutoff) {
    const double squared = *k.cutoff * *k.cutoff;
    if (k.real_bytes == 8)
      glUniform1d(program.cutoff_squared, squared);
    else
      glUniform1f(program.cutoff_squared, GLfloat(squared));
  }
  glUniform4ui(program.work, run.others, pair_chunk(run.others), range.end - range.begin, range.begin);
  dispatch(program.range, range.begin, range.end, limits, chunks_of(run));
}
void apply_pairs(const KernelRun& run, const OwnProgram& program, const Range& range, const GlLimits& limits) {
  glUniform4ui(program.totals.work, chunks_of(run), 0, range.end - range.begin, range.begin);
  dispatch(program.totals.range, range.begin, range.end, limits);
}

// ---- joints with their bodies -------------------------------------------------------------------------
void make_terms(const KernelRun& run, const OwnProgram& program, const GlLimits& limits) {
  glUniform4ui(program.work, 0, 0, run.others + 1, 0);
  dispatch(program.range, run.ranges[0].begin, run.ranges[0].end, limits);
}
void add_terms(const KernelRun& run, const OwnProgram& program, const GlLimits& limits) {
  glUniform4ui(program.totals.work, 0, 0, run.others + 1, 0);
  dispatch(program.totals.range, run.ranges[1].begin, run.ranges[1].end, limits);
}

// ---- reductions ---------------------------------------------------------------------------------------
/// Of each block of rows, and of the levels above.
std::size_t reduction_values(std::uint32_t count) {
  return std::size_t{count} / (reduction_block / 2) + reduction_block;
}

void start_reduction(const OwnProgram& program, const Range& range, const GlLimits& limits) {
  glUniform4ui(program.work, 0, 0, std::uint32_t(reduction_values(range.end - range.begin)), range.begin);
  dispatch(program.range, range.begin, range.end, limits);
}
/// Level by level, until one value is left, which goes into its property.
void reduce(const OwnProgram& program, const Range& range) {
  const auto blocks_of = [](std::uint32_t count) { return (count + reduction_block - 1) / reduction_block; };
  const std::uint32_t rows = range.end - range.begin, room = std::uint32_t(reduction_values(rows));
  std::uint32_t first = 0, count = blocks_of(rows);
  for (bool last = false; !last;) {
    last = count <= reduction_block;
    glUniform4ui(program.totals.work, first, count, room, first + count);
    glUniform2ui(program.totals.range, 0, last);
    glDispatchCompute(std::max(blocks_of(count), 1u), 1, 1);
    first += count;
    count = blocks_of(count);
    if (!last) glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }
}

}  // namespace

Status OwnPrograms::prepare(const OwnKernel& kernel, const SourceOptions& options, const ProgramCache& cache) {
  if (programs_.contains(kernel.serial)) return {};
  Result<OwnProgram> loaded = load_kernel(kernel, options, cache);
  if (!loaded) return loaded.error();
  programs_.emplace(kernel.serial, std::move(*loaded));
  return {};
}

void OwnPrograms::release() {
  for (const auto& [serial, program] : programs_) {
    glDeleteProgram(program.id);
    if (program.totals.id != 0) glDeleteProgram(program.totals.id);
  }
  sums_.release();
}

Result<std::int32_t> OwnPrograms::bind(const OwnKernel& kernel, std::size_t info, GlMemory& memory) const {
  if (Status status = memory.bind(kernel.accesses, kernel.name); !status) return status.error();
  if (Status status = memory.bind_info(info); !status) return status.error();
  const OwnProgram& program = of(kernel);
  glUseProgram(program.id);
  set_parameters(kernel, program);
  return program.range;
}

Status OwnPrograms::run_in_two(const KernelRun& run, GlMemory& memory) {
  const OwnKernel& k = *run.own;
  const OwnProgram& program = of(k);
  const GlLimits& limits = memory.limits();
  if (k.form == OwnKernel::Form::joined)
    return run_in_two(
        run, std::size_t{run.others} + 1, memory, [&] { make_terms(run, program, limits); },
        [&] { add_terms(run, program, limits); });
  for (const Range& range : run.ranges) {
    const std::uint32_t count = range.end - range.begin;
    Status status;
    if (k.form == OwnKernel::Form::reduction)
      status = run_in_two(
          run, reduction_values(count), memory, [&] { start_reduction(program, range, limits); },
          [&] { reduce(program, range); });
    else if (count > 0)
      status = run_in_two(
          run, std::size_t{count} * chunks_of(run), memory, [&] { sum_pairs(run, program, range, limits); },
          [&] { apply_pairs(run, program, range, limits); });
    if (!status) return status;
  }
  return {};
}

template <class First, class Second>
Status OwnPrograms::run_in_two(const KernelRun& run, std::size_t values, GlMemory& memory, First first, Second second) {
  const OwnKernel& k = *run.own;
  const OwnProgram& program = of(k);
  std::size_t words = 0;
  for (const OwnArgument& a : k.arguments)
    if (a.summed()) words += std::size_t{components(a.type)} * number_words(a.type, k.real_bytes);
  Status status =
      sums_.resize("sums of a kernel of the host's own", values * words * 4, memory.limits().storage_block_bytes);
  if (!status) return status;
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);  // others may still read or write there
  status = memory.bind(k.first, k.name);
  if (status) status = memory.bind_info(run.info);
  if (!status) return status;
  bind_sums(k.first);
  glUseProgram(program.id);
  set_parameters(k, program);
  first();
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  if (status = memory.bind(k.second, k.name); !status) return status;
  bind_sums(k.second);
  glUseProgram(program.totals.id);
  second();
  return {};
}

void OwnPrograms::bind_sums(std::span<const Access> beside) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(beside.size()), sums_.id());
}

}  // namespace pcphys
