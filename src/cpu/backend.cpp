// The CPU backend: kernels run in place on the world's tables, in the lane count that was chosen.
#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "cpu/kernels.h"
#include "cpu/own_runs.h"
#include "cpu/workers.h"
#include "step/backend.h"
#include "world/memory.h"

namespace pcphys {

#ifdef PCPHYS_HAVE_X86_LANES
bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
}
#endif

namespace {

/// The compiled kernels of that many lanes, or null where the build or the processor has none.
const CpuKernels* find_kernels(Precision precision, std::uint32_t lanes) {
  const bool f64 = precision == Precision::f64;
  if (lanes == 1) return f64 ? &cpu_kernels_d1 : &cpu_kernels_f1;
#ifdef PCPHYS_HAVE_X86_LANES
  if (lanes == 4 && f64 && __builtin_cpu_supports("avx2")) return &cpu_kernels_d4;
  if (lanes == 4 && !f64 && __builtin_cpu_supports("sse4.2")) return &cpu_kernels_f4;
  if (lanes == 8 && !f64 && has_avx512()) return &cpu_kernels_f8v;
  if (lanes == 8 && !f64 && __builtin_cpu_supports("avx2")) return &cpu_kernels_f8;
#endif
  return nullptr;
}

/// Those for what would leave lanes empty. One lane is not the plain reference where the processor has more registers.
const CpuKernels* find_narrower(Precision precision, std::uint32_t lanes) {
#ifdef PCPHYS_HAVE_X86_LANES
  if (lanes == 1 && has_avx512()) return precision == Precision::f64 ? &cpu_kernels_d1v : &cpu_kernels_f1v;
#endif
  return find_kernels(precision, lanes);
}

class CpuBackend final : public Backend {
 public:
  /// `narrower`: also kernels of fewer lanes, for what would leave lanes empty.
  CpuBackend(const CpuKernels& kernels, bool narrower, const Workers* workers) : kernels_(kernels), workers_(workers) {
    of_lanes_[kernels.lanes] = &kernels;
    if (!narrower) return;
    for (std::uint32_t lanes : {1u, 4u})
      if (lanes < kernels.lanes) of_lanes_[lanes] = find_narrower(kernels.f64 ? Precision::f64 : Precision::f32, lanes);
  }

  std::string device() const override {
    return kernels_.lanes == 1 ? "cpu, scalar" : "cpu, " + std::to_string(kernels_.lanes) + " lanes";
  }
  std::uint32_t width() const override { return kernels_.lanes; }
  std::uint32_t width_for(Domain, std::uint32_t count) const override {
    for (std::uint32_t lanes = std::max(count, 1u); lanes < width(); lanes++)
      if (of_lanes_[lanes]) return lanes;
    return width();
  }

  Status attach(Buffer buffer, void* host, std::size_t) override {
    if (buffers_.size() <= std::size_t(buffer)) buffers_.resize(std::size_t(buffer) + 1);
    buffers_[std::size_t(buffer)] = host;
    return {};
  }
  Status reserve(Buffer buffer, std::size_t slots) override {
    AlignedBytes& rows = scratch_[std::size_t(buffer)];
    rows.resize(slots * schema(buffer).reals * (kernels_.f64 ? 8 : 4));
#ifndef NDEBUG
    std::memset(rows.data(), 0xff, rows.size());  // not numbers: what a step leaves here means nothing to the next
#endif
    buffers_[std::size_t(buffer)] = rows.data();
    return {};
  }
  const void* scratch(Buffer buffer) const override { return scratch_[std::size_t(buffer)].data(); }
  std::size_t held_bytes(Buffer buffer) const override {
    return std::size_t(buffer) < scratch_.size() ? scratch_[std::size_t(buffer)].capacity() : 0;
  }
  std::size_t sum_bytes() const override { return own_.sum_bytes(); }
  Status upload(Buffer) override { return {}; }
  Status download(Buffer) override { return {}; }
  Status set_infos(const void* infos, std::size_t) override {
    infos_ = static_cast<const std::byte*>(infos);
    return {};
  }
  Status run(std::span<const KernelRun> runs) override {
    const bool shared = workers_ && workers_->threads() > 1;
    const std::size_t info_bytes = kernels_.f64 ? sizeof(InfoOf<double>) : sizeof(InfoOf<float>);
    for (const KernelRun& r : runs) {
      if (r.own) {
        own_.run(r, buffers_, infos_ + r.info * info_bytes, workers_);
        continue;
      }
      const auto part = of_lanes_[r.lanes]->run[std::size_t(r.kernel)];
      const std::byte* with = infos_ + r.info * info_bytes;
      if (shared)
        share(part, with, r.ranges, schema(r.kernel).domain == Domain::body ? r.lanes : 1);
      else
        for (const Range& range : r.ranges) part({buffers_.data(), with, range.begin, range.end});
    }
    return {};
  }
  Result<bool> take_flag(Buffer buffer, std::uint32_t quad) override {
    void* const row = buffers_[std::size_t(buffer)];
    if (schema(buffer).reals == 0) return take(static_cast<std::uint32_t*>(row));
    return kernels_.f64 ? take(static_cast<double*>(row) + quad * 4 + 3)
                        : take(static_cast<float*>(row) + quad * 4 + 3);
  }
  Status finish() override { return {}; }
  Status prepare(const OwnKernel& kernel) override {
    if (kernel.in_cpp()) return {};
    return Error{
        ErrorCode::unavailable,
        "The kernel \"" + kernel.name + "\" has no C++ side; put its stage on gl, or write it with PCPHYS_KERNEL."};
  }

 private:
  template <class Scalar> static bool take(Scalar* flag) { return std::exchange(*flag, Scalar(0)) != 0; }
  static constexpr std::uint32_t most_lanes = 8;
  static constexpr std::uint32_t grain = 16;  // blocks of lanes that are worth another thread

  /// `unit`: what no piece may cut.
  void share(void (*part)(const KernelCall&), const std::byte* with, std::span<const Range> ranges,
             std::uint32_t unit) const {
    for (const Range& range : ranges)
      workers_->run((range.end - range.begin + unit - 1) / unit, grain, [&](std::uint32_t begin, std::uint32_t end) {
        part({buffers_.data(), with, range.begin + begin * unit, range.begin + end * unit});
      });
  }

  const CpuKernels& kernels_;
  std::array<const CpuKernels*, most_lanes + 1> of_lanes_{};  // null: none, or not asked for
  const Workers* workers_;
  std::vector<void*> buffers_ = std::vector<void*>(buffer_count);  // by Buffer
  std::array<AlignedBytes, buffer_count> scratch_;
  OwnRuns own_;
  const std::byte* infos_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<Backend>> make_cpu_backend(Precision precision, std::uint32_t lanes, const Workers* workers) {
  const CpuKernels* kernels = nullptr;
  if (lanes == 0)
    for (std::uint32_t l : {8u, 4u, 1u}) kernels = kernels ? kernels : find_kernels(precision, l);
  else
    kernels = find_kernels(precision, lanes);
  if (!kernels)
    return Error{ErrorCode::unavailable,
                 "There are no kernels of " + std::to_string(lanes) +
                     (precision == Precision::f64 ? " lanes in double (1 or 4 with AVX2)"
                                                  : " lanes in float (1, 4 with SSE4.2, 8 with AVX2)") +
                     " for this processor; use lanes 0 for the widest it has."};
  return std::unique_ptr<Backend>(std::make_unique<CpuBackend>(*kernels, lanes == 0, workers));
}

}  // namespace pcphys
