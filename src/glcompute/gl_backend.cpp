// The GPU side of a step: buffers, bindings, barriers and dispatches. No arithmetic of physics.
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <unordered_map>
#include <utility>

#include "glcompute/context.h"
#include "glcompute/device_probe.h"
#include "glcompute/gl_buffer.h"
#include "glcompute/program.h"
#include "step/backend.h"

namespace pcphys {
namespace {

constexpr std::uint32_t local_size = 64;
/// So many trees of one shape, and more, share blocks of `gl_width` lanes.
constexpr std::uint32_t fewest_alike = 8;

std::string_view label_of(Buffer buffer) { return is_own(buffer) ? "a property of the host's own" : schema(buffer).name; }

class GlBackend final : public Backend {
 public:
  GlBackend(std::unique_ptr<GlContext> context, Precision precision)
      : context_(std::move(context)), cache_(context_->identity()) {
    options_.precision = precision;
    options_.local_size = local_size;
  }
  ~GlBackend() override;
  Status start();

  std::string device() const override { return context_->report().renderer; }
  std::uint32_t width() const override { return gl_width; }
  std::uint32_t width_for(Domain domain, std::uint32_t count) const override { return gl_width_for(domain, count); }
  Status attach(Buffer buffer, void* host, std::size_t bytes) override;
  Status reserve(Buffer buffer, std::size_t slots) override;
  std::size_t held_bytes(Buffer buffer) const override {
    return std::size_t(buffer) < buffers_.size() ? buffers_[std::size_t(buffer)].capacity() : 0;
  }
  Status upload(Buffer buffer) override { return transfer(buffer, &GlBuffer::upload); }
  Status download(Buffer buffer) override { return transfer(buffer, &GlBuffer::download); }
  Status set_infos(const void* infos, std::size_t count) override;
  Status prepare(const OwnKernel& kernel) override;
  Status run(std::span<const KernelRun> runs) override;
  Result<bool> take_flag(Buffer buffer, std::uint32_t quad) override;
  Status finish() override;

 private:
  GlBuffer& at(Buffer buffer) {
    if (buffers_.size() <= std::size_t(buffer)) buffers_.resize(std::size_t(buffer) + 1);
    return buffers_[std::size_t(buffer)];
  }
  std::size_t real_bytes() const { return options_.precision == Precision::f64 ? sizeof(std::uint64_t) : sizeof(std::uint32_t); }
  Status resize(Buffer buffer, std::size_t bytes);
  Status transfer(Buffer buffer, void (GlBuffer::*copy)(GlStaging&) const);
  void settle();
  Status hold();
  void release();
  Status bind(const KernelRun& run);
  Status bind_buffers(std::span<const Access> accesses, std::string_view kernel, std::size_t info);
  Status bind_buffer(Buffer buffer, std::uint32_t binding, std::string_view kernel);
  Status bind_info(std::size_t info);
  Status bind_own(const OwnKernel& kernel, std::size_t info);
  void set_parameters(const OwnKernel& kernel, const OwnProgram& program);
  Status bind_with_sums(const OwnKernel& kernel, std::span<const Buffer> buffers);
  Status run_in_two(const KernelRun& run);
  void run_pairs(const KernelRun& run, const OwnProgram& program, const Range& range, std::uint32_t chunks);
  void start_reduction(const OwnProgram& program, const Range& range, std::uint32_t room);
  void reduce(const KernelRun& run, const OwnProgram& program, std::uint32_t room);
  KernelProgram& program_of(const KernelRun& run) { return programs_[run.lanes == 1][std::size_t(run.kernel)]; }
  std::int32_t range_of(const KernelRun& run);
  void dispatch_all(const KernelRun& run);
  void dispatch(std::int32_t range_location, std::uint32_t begin, std::uint32_t end, std::uint32_t rows = 1);

  std::unique_ptr<GlContext> context_;
  ProgramCache cache_;
  SourceOptions options_;
  std::vector<GlBuffer> buffers_ = std::vector<GlBuffer>(buffer_count);  // by Buffer
  std::unordered_map<std::uint64_t, OwnProgram> own_programs_;           // by serial
  GlStaging staging_;
  GlBuffer sums_;                                                      // between the two programs of a kernel of the host's own
  std::array<std::array<KernelProgram, kernel_count>, 2> programs_{};  // of `gl_width` lanes, and of one
  std::uint32_t info_buffer_ = 0;
  std::size_t info_bytes_ = 0, info_stride_ = 0, info_count_ = 0, info_capacity_ = 0;
  std::vector<char> info_staging_;
  bool writes_pending_ = false;  // of dispatches, not yet visible to transfers
  bool barrier_due_ = false;     // asked for by a run that had nothing to do: the plan counts on it all the same
  bool held_ = false;            // the context stays current from the first run to finish
};

/// The probe decides how this device divides and takes roots; sizes of info blocks follow the device's alignment.
Status GlBackend::start() {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  Result<GlArithmetic> arithmetic = probe_arithmetic(options_.precision, cache_);
  if (!arithmetic) return arithmetic.error();
  options_.division = arithmetic->division;
  options_.square_root = arithmetic->square_root;
  GLint alignment = 1;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  info_bytes_ = options_.precision == Precision::f64 ? sizeof(InfoOf<double>) : sizeof(InfoOf<float>);
  const std::size_t step = std::size_t(std::max(alignment, 1));
  info_stride_ = (info_bytes_ + step - 1) / step * step;
  glGenBuffers(1, &info_buffer_);
  return context_->check("starting the backend");
}

GlBackend::~GlBackend() {
  {
    GlScope scope(*context_);
    if (scope.status()) {  // else a host's context went first, and took everything along
      for (GlBuffer& buffer : buffers_) buffer.release();
      for (const auto& programs : programs_)
        for (const KernelProgram& program : programs)
          if (program.id != 0) glDeleteProgram(program.id);
      for (const auto& [serial, program] : own_programs_) {
        glDeleteProgram(program.id);
        if (program.totals.id != 0) glDeleteProgram(program.totals.id);
      }
      sums_.release();
      staging_.release();
      glDeleteBuffers(1, &info_buffer_);
    }
  }
  release();
}

// ---- memory -----------------------------------------------------------------------------------------
Status GlBackend::resize(Buffer buffer, std::size_t bytes) {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  return at(buffer).resize(label_of(buffer), bytes, context_->report().limits.storage_block_bytes);
}

Status GlBackend::attach(Buffer buffer, void* host, std::size_t bytes) {
  if (Status status = resize(buffer, bytes); !status) return status;
  at(buffer).attach(host, bytes);
  return {};
}

Status GlBackend::reserve(Buffer buffer, std::size_t slots) {
  return resize(buffer, slots * schema(buffer).reals * real_bytes());
}

/// What dispatches wrote becomes visible to transfers, and to dispatches after them: a plan counts a download
/// as a barrier.
void GlBackend::settle() {
  if (writes_pending_) glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
  writes_pending_ = false;
}

Status GlBackend::transfer(Buffer buffer, void (GlBuffer::*copy)(GlStaging&) const) {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  if (!at(buffer).attached() || !at(buffer).transferable())
    return Error{ErrorCode::bad_argument,
                 "The buffer `" + std::string(label_of(buffer)) + "` has no memory on the host; attach it before a transfer."};
  settle();
  (at(buffer).*copy)(staging_);
  return {};
}

Status GlBackend::set_infos(const void* infos, std::size_t count) {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  info_staging_.resize(count * info_stride_);
  for (std::size_t i = 0; i < count; i++)
    std::memcpy(info_staging_.data() + i * info_stride_, static_cast<const char*>(infos) + i * info_bytes_, info_bytes_);
  glBindBuffer(GL_UNIFORM_BUFFER, info_buffer_);
  if (count > info_capacity_) {
    glBufferData(GL_UNIFORM_BUFFER, GLsizeiptr(info_staging_.size()), info_staging_.data(), GL_DYNAMIC_DRAW);
    info_capacity_ = count;
  } else {
    glBufferSubData(GL_UNIFORM_BUFFER, 0, GLsizeiptr(info_staging_.size()), info_staging_.data());
  }
  info_count_ = count;
  return {};
}

// ---- running ----------------------------------------------------------------------------------------
/// Making a context current costs more than a dispatch: from the first run to `finish` it stays.
Status GlBackend::hold() {
  if (held_) return {};
  Status status = context_->enter();
  held_ = bool(status);
  return status;
}

void GlBackend::release() {
  if (held_) context_->leave();
  held_ = false;
}

Status GlBackend::bind_buffers(std::span<const Access> accesses, std::string_view kernel, std::size_t info) {
  std::uint32_t binding = 0;
  for (const Access& access : accesses)
    if (Status status = bind_buffer(access.buffer, binding++, kernel); !status) return status;
  return bind_info(info);
}

Status GlBackend::bind_buffer(Buffer buffer, std::uint32_t binding, std::string_view kernel) {
  if (!at(buffer).attached())
    return Error{ErrorCode::bad_argument, "The kernel `" + std::string(kernel) + "` uses the buffer `" +
                                              std::string(label_of(buffer)) + "`, which was neither attached nor reserved."};
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, at(buffer).id());
  return {};
}

Status GlBackend::bind_info(std::size_t info) {
  if (info >= info_count_)
    return Error{ErrorCode::bad_argument,
                 "There is no info block " + std::to_string(info) + "; set_infos gave " + std::to_string(info_count_) + "."};
  glBindBufferRange(GL_UNIFORM_BUFFER, 0, info_buffer_, GLintptr(info * info_stride_), GLsizeiptr(info_bytes_));
  return {};
}

Status GlBackend::bind(const KernelRun& run) {
  if (run.own) return bind_own(*run.own, run.info);
  KernelProgram& program = program_of(run);
  if (program.id == 0) {
    SourceOptions options = options_;
    options.lanes = run.lanes;
    const Result<KernelProgram> loaded = load_kernel(run.kernel, options, cache_);
    if (!loaded) return loaded.error();
    program = *loaded;
  }
  const KernelSchema& k = schema(run.kernel);
  if (Status status = bind_buffers(k.accesses, k.name, run.info); !status) return status;
  glUseProgram(program.id);
  return {};
}

Status GlBackend::prepare(const OwnKernel& kernel) {
  if (kernel.body.empty())
    return Error{ErrorCode::unavailable,
                 "The kernel \"" + kernel.name + "\" has no GLSL side; put its stage on cpu, or write it with PCPHYS_KERNEL."};
  if (own_programs_.contains(kernel.serial)) return {};
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  Result<OwnProgram> loaded = load_kernel(kernel, options_, cache_);
  if (!loaded) return loaded.error();
  own_programs_.emplace(kernel.serial, std::move(*loaded));
  return {};
}

Status GlBackend::bind_own(const OwnKernel& kernel, std::size_t info) {
  if (Status status = bind_buffers(kernel.accesses, kernel.name, info); !status) return status;
  const OwnProgram& program = own_programs_.at(kernel.serial);
  glUseProgram(program.id);
  set_parameters(kernel, program);
  return {};
}

/// Values of parameters go with each run: they are few, and may have changed.
void GlBackend::set_parameters(const OwnKernel& kernel, const OwnProgram& program) {
  std::size_t i = 0;
  for (const OwnArgument& a : kernel.arguments)
    for (std::uint32_t c = 0; c < components(a.type); c++) {
      const std::int32_t location = program.parameters[i++];
      if (location < 0) continue;
      const double value = read_number(kernel.parameters.data() + a.place + c * number_bytes(a.type, kernel.real_bytes), a.type,
                                       kernel.real_bytes);
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

// ---- pairs and reductions -----------------------------------------------------------------------------
Status GlBackend::bind_with_sums(const OwnKernel& kernel, std::span<const Buffer> buffers) {
  std::uint32_t binding = 0;
  for (const Buffer buffer : buffers)
    if (Status status = bind_buffer(buffer, binding++, kernel.name); !status) return status;
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, sums_.id());
  return {};
}

Status GlBackend::run_in_two(const KernelRun& run) {
  const OwnKernel& k = *run.own;
  const bool pairs = k.form == OwnKernel::Form::pair;
  const OwnProgram& program = own_programs_.at(k.serial);
  std::size_t words = 0;
  for (const OwnArgument& a : k.arguments)
    if (a.summed()) words += std::size_t{components(a.type)} * number_words(a.type, k.real_bytes);
  for (const Range& range : run.ranges) {
    const std::uint32_t count = range.end - range.begin, chunk = pair_chunk(run.others);
    if (pairs && count == 0) continue;
    const std::uint32_t chunks = !pairs || k.cutoff ? 1 : (run.others + chunk - 1) / chunk;
    // a reduction: of each block of rows, and of the levels above
    const std::size_t values = pairs ? std::size_t{count} * chunks : std::size_t{count} / (reduction_block / 2) + reduction_block;
    if (Status status =
            sums_.resize("sums of a kernel of the host's own", values * words * 4, context_->report().limits.storage_block_bytes);
        !status)
      return status;
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);  // others may still read or write there
    if (Status status = bind_with_sums(k, k.read); !status) return status;
    if (Status status = bind_info(run.info); !status) return status;
    glUseProgram(program.id);
    set_parameters(k, program);
    if (pairs)
      run_pairs(run, program, range, chunks);
    else
      start_reduction(program, range, std::uint32_t(values));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    if (Status status = bind_with_sums(k, k.written); !status) return status;
    glUseProgram(program.totals.id);
    if (pairs) {
      glUniform4ui(program.totals.work, chunks, 0, count, range.begin);
      dispatch(program.totals.range, range.begin, range.end);
    } else {
      reduce(run, program, std::uint32_t(values));
    }
    writes_pending_ = true;
    barrier_due_ = false;
  }
  return {};
}

void GlBackend::run_pairs(const KernelRun& run, const OwnProgram& program, const Range& range, std::uint32_t chunks) {
  const OwnKernel& k = *run.own;
  if (k.cutoff) {
    const double squared = *k.cutoff * *k.cutoff;
    if (options_.precision == Precision::f64)
      glUniform1d(program.cutoff_squared, squared);
    else
      glUniform1f(program.cutoff_squared, GLfloat(squared));
  }
  glUniform4ui(program.work, run.others, pair_chunk(run.others), range.end - range.begin, range.begin);
  dispatch(program.range, range.begin, range.end, chunks);
}

void GlBackend::start_reduction(const OwnProgram& program, const Range& range, std::uint32_t room) {
  glUniform4ui(program.work, 0, 0, room, range.begin);
  dispatch(program.range, range.begin, range.end);
}

/// Level by level, until one value is left, which goes into its property.
void GlBackend::reduce(const KernelRun& run, const OwnProgram& program, std::uint32_t room) {
  const auto blocks_of = [](std::uint32_t count) { return (count + reduction_block - 1) / reduction_block; };
  std::uint32_t first = 0, count = blocks_of(run.ranges[0].end - run.ranges[0].begin);
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

std::int32_t GlBackend::range_of(const KernelRun& run) {
  return run.own ? own_programs_.at(run.own->serial).range : program_of(run).range;
}

/// Long ranges go in pieces of as many work groups as the device takes; pieces need no barrier.
void GlBackend::dispatch(std::int32_t range_location, std::uint32_t begin, std::uint32_t end, std::uint32_t rows) {
  const std::uint64_t piece = std::uint64_t(context_->report().limits.work_group_count) * local_size;
  for (std::uint64_t k = begin; k < end; k += piece) {
    const std::uint32_t stop = std::uint32_t(std::min<std::uint64_t>(end, k + piece));
    glUniform2ui(range_location, std::uint32_t(k), stop);
    glDispatchCompute((stop - std::uint32_t(k) + local_size - 1) / local_size, rows, 1);
  }
}

void GlBackend::dispatch_all(const KernelRun& run) {
  const std::uint32_t lanes = run.own || one_by_one(schema(run.kernel).domain) ? 1 : run.lanes;
  for (const Range& range : run.ranges) {
    if (range.begin >= range.end) continue;
    if (barrier_due_) glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    dispatch(range_of(run), range.begin * lanes, range.end * lanes);
    barrier_due_ = true;  // each range may read what the one before wrote
    writes_pending_ = true;
  }
  barrier_due_ = false;  // what runs next says itself whether it reads what this one wrote
}

Status GlBackend::run(std::span<const KernelRun> runs) {
  for (const KernelRun& run : runs) {
    barrier_due_ |= run.barrier;
    if (run.own && run.own->form != OwnKernel::Form::element) {
      Status status = hold();
      if (status) status = run_in_two(run);
      if (!status) return release(), status;
      continue;
    }
    if (std::ranges::all_of(run.ranges, [](const Range& r) { return r.begin >= r.end; })) continue;
    if (Status status = hold(); !status) return status;
    if (Status status = bind(run); !status) {
      release();
      return status;
    }
    dispatch_all(run);
  }
  return {};
}

Result<bool> GlBackend::take_flag(Buffer buffer, std::uint32_t quad) {
  if (Status status = hold(); !status) return status.error();
  settle();
  if (schema(buffer).reals == 0) return at(buffer).take(staging_, 0, sizeof(std::uint32_t));
  const std::size_t bytes = real_bytes();
  return at(buffer).take(staging_, (quad * 4 + 3) * bytes, bytes);
}

Status GlBackend::finish() {
  if (Status status = hold(); !status) return status;
  glFinish();
  const Status status = context_->check("running a step");
  release();
  return status;
}

}  // namespace

/// Trees of which few are alike would leave most lanes of their blocks, and of their memory, empty.
std::uint32_t gl_width_for(Domain domain, std::uint32_t count) {
  return domain == Domain::tree && count < fewest_alike ? 1 : gl_width;
}

Result<std::unique_ptr<Backend>> make_gl_backend(Precision precision, int device, bool host_context) {
  Result<std::unique_ptr<GlContext>> context = host_context ? GlContext::adopt_current() : GlContext::open(device);
  if (!context) return context.error();
  auto backend = std::make_unique<GlBackend>(std::move(*context), precision);
  if (Status status = backend->start(); !status) return status.error();
  return std::unique_ptr<Backend>(std::move(backend));
}

}  // namespace pcphys
