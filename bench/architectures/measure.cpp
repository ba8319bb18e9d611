#include "measure.h"

#include <epoxy/gl.h>
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "glcompute/context.h"
#include "glcompute/gl_buffer.h"

namespace pcphys::architectures {
namespace {

constexpr double enough_time = 0.05;        // of steps [s]
constexpr std::size_t long_steps = 10'000;  // bodies, from which on a step is long enough to be interrupted
constexpr std::size_t least_repeats = 3, most_repeats = 1000, warm_up = 1;

/// What another process answers; null if it answers nothing.
Json in_another_process(const std::function<Json()>& work) {
  int ends[2];
  if (pipe(ends) != 0) return nullptr;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const std::string text = work().dump();
    const bool sent = ::write(ends[1], text.data(), text.size()) == ssize_t(text.size());
    _exit(sent ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  char part[4096];
  for (ssize_t count; (count = ::read(ends[0], part, sizeof part)) > 0;) text.append(part, std::size_t(count));
  close(ends[0]);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0) return nullptr;
  return Json::parse(text, nullptr, false);
}

std::size_t heap_bytes() {
  const auto heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Calls of `action` until they have taken enough time in all; it adds its times itself.
void repeat(const std::function<void()>& action) {
  const double begin = wall_time();
  for (std::size_t i = 0; i < most_repeats && (i < least_repeats || wall_time() - begin < enough_time); i++) action();
}

Json measure_here(const Case& of) {
  const Clock clock = of.bodies < long_steps ? wall_time : processor_time;
  const std::size_t before = heap_bytes();
  const double begin = clock();
  const auto design = of.design->make();
  const auto handles = build(of.scene, of.bodies, of.history, *design);
  const double build_time = clock() - begin;
  const std::size_t bytes = heap_bytes() - before - handles.capacity() * sizeof(Handle);

  const Steps with(clock);
  std::vector<float> packed(handles.size() * packed_reals);
  for (std::size_t i = 0; i < warm_up; i++) with.step(of.scene, *design);
  std::vector<double> stages[stage_count], gathers, scatters, settles;
  repeat([&] {
    StageTimes times{};
    with.step(of.scene, *design, &times);
    for (std::size_t s = 0; s < stage_count; s++) stages[s].push_back(times[s]);
    const double start = clock();
    design->gather(packed.data());
    const double between = clock();
    design->scatter(packed.data());
    gathers.push_back(between - start), scatters.push_back(clock() - between);
  });
  repeat([&] {
    const double start = clock();
    design->settle();
    settles.push_back(clock() - start);
  });
  return {{"bodies", handles.size()},
          {"integrate", median(stages[std::size_t(Stage::integrate)])},
          {"joints", median(stages[std::size_t(Stage::joints)])},
          {"impulses", median(stages[std::size_t(Stage::impulses)])},
          {"gather", median(gathers)},
          {"scatter", median(scatters)},
          {"build", build_time},
          {"settle", median(settles)},
          {"bytes", bytes}};
}

/// Seconds of an upload and of a download of buffers of these sizes.
Json time_transfers(std::span<const std::size_t> sizes, std::uint64_t limit) {
  std::vector<GlBuffer> buffers(sizes.size());
  GlStaging staging;
  std::vector<std::vector<float>> hosts;
  for (std::size_t i = 0; i < sizes.size(); i++) {
    hosts.emplace_back(sizes[i] / sizeof(float), 1.0f);
    if (Status made = buffers[i].resize("transfer", sizes[i], limit); !made) return {{"problem", made.error().message}};
    buffers[i].attach(hosts[i].data(), sizes[i]);
  }
  const auto time = [&](void (GlBuffer::*copy)(GlStaging&) const) {
    std::vector<double> times;
    repeat([&] {
      const double start = wall_time();
      for (const GlBuffer& buffer : buffers) (buffer.*copy)(staging);
      glFinish();
      times.push_back(wall_time() - start);
    });
    return median(times);
  };
  (void)time(&GlBuffer::upload);  // the first ones touch memory that was not there
  return {{"upload", time(&GlBuffer::upload)}, {"download", time(&GlBuffer::download)}};
}

}  // namespace

std::optional<Json> measure(const Case& of) {
  if (!of.design->make()) return std::nullopt;
  Json row{{"design", of.design->name}, {"scene", name(of.scene)}, {"history", name(of.history)}};
  const Json found = in_another_process([&] { return measure_here(of); });
  if (!found.is_object()) {
    std::fprintf(stderr, "pcphys_architectures: %s, %s, %zu bodies did not end; is there memory enough?\n",
                 of.design->name, std::string(name(of.scene)).c_str(), of.bodies);
    std::exit(1);
  }
  row.update(found);
  return row;
}

void only_step(const Case& of, std::size_t steps) {
  const auto design = of.design->make();
  if (!design) return;
  (void)build(of.scene, of.bodies, of.history, *design);
  const Steps with;
  for (std::size_t i = 0; i < steps; i++) with.step(of.scene, *design);
}

Json measure_transfers(std::size_t bodies) {
  return in_another_process([&]() -> Json {
    auto context = GlContext::open(-1);
    if (!context) return {{"problem", context.error().message}};
    const GlScope scope(**context);
    if (!scope.status()) return {{"problem", scope.status().error().message}};
    const GlReport& report = (*context)->report();
    const std::size_t packed[] = {bodies * packed_reals * sizeof(float)};
    const std::size_t blocks[] = {bodies * length_of(Buffer::pose) * sizeof(float),
                                  bodies * length_of(Buffer::motion) * sizeof(float)};
    const std::uint64_t limit = report.limits.storage_block_bytes;
    return {{"bodies", bodies},
            {"device", report.renderer},
            {"software", report.software},
            {"packed", time_transfers(packed, limit)},
            {"blocks", time_transfers(blocks, limit)}};
  });
}

}  // namespace pcphys::architectures
