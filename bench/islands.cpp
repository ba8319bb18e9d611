// What it costs to find who is in which island, from contacts that are there: by union-find on the host, and by label
// propagation on a device, with the list of edges, the transfers and the waits for each round.
//   islands/GRAPH/BODIES/PLACE
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "plan/islands.h"
#include "plan/plan.h"
#include "step/runner.h"
#include "step/schedule.h"
#include "world/state.h"

namespace {

using namespace pcphys;

using Edges = std::vector<std::array<std::uint32_t, 2>>;

/// A chain of bodies in any order, the worst for labels.
Edges chain(std::uint32_t count) {
  std::vector<std::uint32_t> rows(count);
  std::iota(rows.begin(), rows.end(), 1u);
  std::ranges::shuffle(rows, std::mt19937(1));
  Edges edges;
  for (std::size_t i = 0; i + 1 < rows.size(); i++) edges.push_back({rows[i], rows[i + 1]});
  return edges;
}
/// As many contacts as a pile has: three a body.
Edges pile(std::uint32_t count) {
  std::mt19937 lots(1);
  Edges edges;
  for (std::uint32_t i = 0; i < 3 * count; i++)
    edges.push_back({1 + std::uint32_t(lots() % count), 1 + std::uint32_t(lots() % count)});
  return edges;
}

World bodies(std::uint32_t count, const Edges& edges) {
  World world;
  BodyDef def;
  def.shapes = {ShapeDef::sphere(0.5)};
  for (std::uint32_t i = 0; i < count; i++) (void)world.create_body(def);
  world.state().contacts.ends = edges;
  return world;
}

void on_cpu(benchmark::State& state, std::uint32_t count, Edges (*graph)(std::uint32_t)) {
  const World world = bodies(count, graph(count));
  Islands islands;
  for (auto _ : state) {
    islands.forget();
    islands.build(world.state());
    std::uint32_t sum = 0;
    for (std::uint32_t row = 1; row <= count; row++) sum += islands.root(row);
    benchmark::DoNotOptimize(sum);
  }
}

void on_gl(benchmark::State& state, std::uint32_t count, Edges (*graph)(std::uint32_t)) {
  World world = bodies(count, graph(count));
  StepSettings settings;
  settings.sleep = true;
  settings.islands = Place::gl;
  settings.timings = false;
  PlanSignature signature;
  signature.islands = true;
  const StepPlan plan = make_plan(signature);
  const std::array<InfoOf<float>, phase_count> infos{};
  Runner runner;
  Schedule schedule;
  StepReport report;
  Status ok = runner.prepare(settings, Precision::f32);
  for (auto _ : state) {
    if (!ok) break;
    schedule.islands.list(world.state());
    ok = runner.bind(settings, plan, world.state(), schedule);
    if (ok) ok = runner.run(world.state(), schedule, infos.data(), report);
    if (ok && !schedule.islands.take()) return state.SkipWithError("the labels fall for ever");
  }
  if (!ok) return state.SkipWithError(ok.error().message.c_str());
  state.counters["bytes"] = benchmark::Counter(double(report.transfer_bytes), benchmark::Counter::kAvgIterations);
}

const bool registered = [] {
  for (const std::uint32_t count : {1'000u, 10'000u, 100'000u})
    for (const auto& [name, graph] : {std::pair{"chain", &chain}, std::pair{"pile", &pile}}) {
      const std::string what = std::string("islands/") + name + "/" + std::to_string(count);
      benchmark::RegisterBenchmark((what + "/cpu").c_str(), on_cpu, count, graph)
          ->Unit(benchmark::kMicrosecond)
          ->UseRealTime();
      benchmark::RegisterBenchmark((what + "/gl").c_str(), on_gl, count, graph)
          ->Unit(benchmark::kMicrosecond)
          ->UseRealTime();
    }
  return true;
}();

}  // namespace
