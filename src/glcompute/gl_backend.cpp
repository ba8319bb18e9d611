// The GPU side of a step: buffers, bindings, barriers and dispatches. No arithmetic of physics.
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "glcompute/context.h"
#include "glcompute/device_probe.h"
#include "glcompute/gl_memory.h"
#include "glcompute/gl_queue.h"
#include "glcompute/own_programs.h"
#include "glcompute/program.h"
#include "step/backend.h"

namespace pcphys {
namespace {

/// So many trees of one shape, and more, share blocks of `gl_width` lanes.
constexpr std::uint32_t fewest_alike = 8;

class GlBackend final : public Backend {
 public:
  GlBackend(std::unique_ptr<GlContext> context, Precision precision)
      : context_(std::move(context)), cache_(context_->identity()) {
    options_.precision = precision;
  }
  ~GlBackend() override;
  Status start();

  std::string device() const override { return context_->report().renderer; }
  std::uint32_t width() const override { return gl_width; }
  std::uint32_t width_for(Domain domain, std::uint32_t count) const override { return gl_width_for(domain, count); }
  Status attach(Buffer buffer, void* host, std::size_t bytes) override;
  Status reserve(Buffer buffer, std::size_t slots) override;
  std::size_t held_bytes(Buffer buffer) const override { return memory_.held_bytes(buffer); }
  std::size_t sum_bytes() const override { return own_.sum_bytes(); }
  Status upload(Buffer buffer) override { return transfer(buffer, &GlBuffer::upload); }
  Status download(Buffer buffer) override { return transfer(buffer, &GlBuffer::download); }
  Status keep(Buffer buffer) override;
  Status put_back(Buffer buffer) override;
  Status set_infos(const void* infos, std::size_t count) override;
  Status prepare(const OwnKernel& kernel) override;
  Status run(std::span<const KernelRun> runs) override;
  Result<bool> take_flag(Buffer buffer, std::uint32_t quad) override;
  Status finish() override;

 private:
  std::size_t real_bytes() const {
    return options_.precision == Precision::f64 ? sizeof(std::uint64_t) : sizeof(std::uint32_t);
  }
  Status resize(Buffer buffer, std::size_t bytes);
  Status transfer(Buffer buffer, void (GlBuffer::*copy)(GlStaging&) const);
  void settle();
  Status hold();
  void release();
  Result<std::int32_t> bind(const KernelRun& run);
  SourceOptions options_of(const KernelRun& run) const;
  KernelProgram& program_of(const KernelRun& run) { return programs_[run.lanes == 1][std::size_t(run.kernel)]; }
  Status run_at_once(const KernelRun& run);
  Status run_in_two(const KernelRun& run);
  void dispatch_all(const KernelRun& run, std::int32_t range_location);

  std::unique_ptr<GlContext> context_;
  ProgramCache cache_;
  SourceOptions options_;
  GlMemory memory_;
  GlStaging staging_;
  GlQueue queue_;
  OwnPrograms own_;
  std::array<std::array<KernelProgram, kernel_count>, 2> programs_{};  // of `gl_width` lanes, and of one
  bool writes_pending_ = false;                                        // of dispatches, not yet visible to transfers
  bool barrier_due_ = false;  // asked for by a run that had nothing to do: the plan counts on it all the same
  bool held_ = false;         // the context stays current from the first run to finish
};

/// The probe decides how this device divides and takes roots.
Status GlBackend::start() {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  Result<GlArithmetic> arithmetic = probe_arithmetic(options_.precision, cache_);
  if (!arithmetic) return arithmetic.error();
  options_.division = arithmetic->division;
  options_.square_root = arithmetic->square_root;
  const GlTeam team = gl_team();
  options_.team = team.size != 0 ? team.size : context_->report().software ? 1 : gl_team_size;
  options_.scattered = team.scattered;
  memory_.start(options_.precision, context_->report().limits);
  return context_->check("starting the backend");
}

GlBackend::~GlBackend() {
  {
    GlScope scope(*context_);
    if (scope.status()) {  // else a host's context went first, and took everything along
      for (const auto& programs : programs_)
        for (const KernelProgram& program : programs)
          if (program.id != 0) glDeleteProgram(program.id);
      queue_.release();
      own_.release();
      memory_.release();
      staging_.release();
    }
  }
  release();
}

// ---- memory -----------------------------------------------------------------------------------------
Status GlBackend::resize(Buffer buffer, std::size_t bytes) {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  return memory_.resize(buffer, bytes);
}

Status GlBackend::attach(Buffer buffer, void* host, std::size_t bytes) {
  if (Status status = resize(buffer, bytes); !status) return status;
  memory_.at(buffer).attach(host, bytes);
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
  if (Status status = memory_.check_transferable(buffer); !status) return status;
  settle();
  (memory_.at(buffer).*copy)(staging_);
  return {};
}

Status GlBackend::keep(Buffer buffer) {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  settle();
  return memory_.keep(buffer);
}

Status GlBackend::put_back(Buffer buffer) {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  settle();
  memory_.at(buffer).put_back();
  return {};
}

Status GlBackend::set_infos(const void* infos, std::size_t count) {
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  memory_.set_infos(infos, count);
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

SourceOptions GlBackend::options_of(const KernelRun& run) const {
  SourceOptions options = options_;
  options.lanes = run.lanes;
  return options;
}

/// For a dispatch; where the program has pc_range.
Result<std::int32_t> GlBackend::bind(const KernelRun& run) {
  if (run.own) return own_.bind(*run.own, run.info, memory_);
  KernelProgram& program = program_of(run);
  if (program.id == 0) {
    const Result<KernelProgram> loaded = load_kernel(run.kernel, options_of(run), cache_);
    if (!loaded) return loaded.error();
    program = *loaded;
  }
  const KernelSchema& k = schema(run.kernel);
  Status status = memory_.bind(k.accesses, k.name);
  if (status) status = memory_.bind_info(run.info);
  if (!status) return status.error();
  glUseProgram(program.id);
  return program.range;
}

Status GlBackend::prepare(const OwnKernel& kernel) {
  if (kernel.body.empty())
    return Error{
        ErrorCode::unavailable,
        "The kernel \"" + kernel.name + "\" has no GLSL side; put its stage on cpu, or write it with PCPHYS_KERNEL."};
  GlScope scope(*context_);
  if (!scope.status()) return scope.status();
  return own_.prepare(kernel, options_, cache_);
}

void GlBackend::dispatch_all(const KernelRun& run, std::int32_t range_location) {
  const std::uint32_t lanes = run.own || one_by_one(schema(run.kernel).domain) ? 1 : run.lanes;
  for (const Range& range : run.ranges) {
    if (range.begin >= range.end) continue;
    if (barrier_due_) glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    if (!run.own && is_shared(run.kernel, options_of(run)))
      dispatch(range_location, range.begin, range.end, memory_.limits(), 1, 1);
    else
      dispatch(range_location, range.begin * lanes, range.end * lanes, memory_.limits());
    queue_.dispatched();
    barrier_due_ = true;  // each range may read what the one before wrote
    writes_pending_ = true;
  }
  barrier_due_ = false;  // what runs next says itself whether it reads what this one wrote
}

Status GlBackend::run(std::span<const KernelRun> runs) {
  for (const KernelRun& run : runs) {
    barrier_due_ |= run.barrier;
    const bool reduction = run.own && run.own->form == OwnKernel::Form::reduction;  // of no rows, too
    if (!reduction && std::ranges::all_of(run.ranges, [](const Range& r) { return r.begin >= r.end; })) continue;
    Status status = hold();
    if (status) status = run.own && run.own->form != OwnKernel::Form::element ? run_in_two(run) : run_at_once(run);
    if (!status) return release(), status;
  }
  return {};
}

Status GlBackend::run_at_once(const KernelRun& run) {
  const Result<std::int32_t> range_location = bind(run);
  if (!range_location) return range_location.error();
  dispatch_all(run, *range_location);
  return {};
}

Status GlBackend::run_in_two(const KernelRun& run) {
  if (Status status = own_.run_in_two(run, memory_); !status) return status;
  queue_.dispatched();
  writes_pending_ = true;
  barrier_due_ = false;
  return {};
}

Result<bool> GlBackend::take_flag(Buffer buffer, std::uint32_t quad) {
  if (Status status = hold(); !status) return status.error();
  settle();
  if (schema(buffer).reals == 0) return memory_.at(buffer).take(staging_, 0, sizeof(std::uint32_t));
  const std::size_t bytes = real_bytes();
  return memory_.at(buffer).take(staging_, (quad * 4 + 3) * bytes, bytes);
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
  return of_trees(domain) && count < fewest_alike ? 1 : gl_width;
}

GlTeam& gl_team() {
  static GlTeam team = [] {
    const char* size = std::getenv("PCPHYS_GL_TEAM");
    return GlTeam{size != nullptr ? std::min(std::uint32_t(std::strtoul(size, nullptr, 10)), gl_largest_team) : 0};
  }();
  return team;
}

Result<std::unique_ptr<Backend>> make_gl_backend(Precision precision, int device, bool host_context) {
  Result<std::unique_ptr<GlContext>> context = host_context ? GlContext::adopt_current() : GlContext::open(device);
  if (!context) return context.error();
  auto backend = std::make_unique<GlBackend>(std::move(*context), precision);
  if (Status status = backend->start(); !status) return status.error();
  return std::unique_ptr<Backend>(std::move(backend));
}

}  // namespace pcphys
