// Whole scenes, pcphys beside Bullet in the same run: 600 steps of 1/60 s, one thread, nothing sleeps, each
// engine's defaults (pcphys 4 sub-steps, Bullet 10 iterations). The two take turns of 20 steps, so that what
// else happens on the machine hits both. The time of a benchmark is pcphys's median step.
//   pcphys_bench --benchmark_filter=scene/balls_1000        PCPHYS_BENCH_STEPS=100 for a quick look
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "pcphys/step.h"
#include "peers/peer.h"
#include "scenes/metrics.h"

namespace {

using namespace pcphys;

constexpr double dt = 1.0 / 60;
constexpr int turn = 20;

int step_count() {
  const char* text = std::getenv("PCPHYS_BENCH_STEPS");
  return text ? std::max(1, std::atoi(text)) : 600;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Milliseconds that `action` takes.
template <class Action> double clock_ms(Action action) {
  const auto begin = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

struct Variant {
  const char* name;
  Place place;
  std::uint32_t lanes;
  Precision precision;
};

struct Case {
  const char* scene;
  int count;
};

void compare(benchmark::State& state, Case scene_case, Variant variant) {
  World world({variant.precision});
  scenes::SceneOptions options;
  options.count = scene_case.count;
  const auto scene = scenes::make(scene_case.scene, options, world);
  if (!scene) return state.SkipWithError(scene.error().message.c_str());
  StepSettings settings;
  settings.set_all(variant.place);
  settings.lanes = variant.lanes;
  settings.timings = false;
  Stepper stepper(settings);
  std::vector<BodyId> ids;
  for (const scenes::SceneBody& body : scene->bodies) ids.push_back(body.id);
  const auto bullet = peers::make("bullet", world, ids);  // without it the benchmark still runs

  std::vector<double> own, peer;
  scenes::RimWatch rim;
  Error error;
  const int steps = step_count();
  for (auto _ : state) {
    for (int done = 0; done < steps && error.code == ErrorCode::none; done += turn) {
      const int count = std::min(turn, steps - done);
      for (int k = 0; k < count && error.code == ErrorCode::none; ++k) {
        own.push_back(clock_ms([&] { error = stepper.step(world, dt).error; }));
        rim.look(*scene, scenes::poses(*scene, world));
      }
      for (int k = 0; k < count && bullet; ++k) peer.push_back(clock_ms([&] { (void)(*bullet)->step(dt); }));
    }
    state.SetIterationTime(median(own) / 1000);
  }
  if (error.code != ErrorCode::none) return state.SkipWithError(error.message.c_str());

  const scenes::Metrics end = scenes::measure(*scene, world, rim);
  state.counters["ms"] = median(own);
  state.counters["overlap_mm"] = 1000 * end.penetration.max;
  if (!scene->joints.empty()) state.counters["joint_mm"] = 1000 * end.separation.max;
  if (end.escapes.through || end.nonfinite || end.drift.fallen)
    state.counters["lost"] = double(end.escapes.through + end.nonfinite + end.drift.fallen);
  std::string label = stepper.device(variant.place);
  if (bullet) {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < ids.size(); ++i) poses.push_back((*bullet)->pose(i));
    state.counters["bullet_ms"] = median(peer);
    state.counters["bullet_overlap_mm"] = 1000 * scenes::penetration(*scene, world, poses).max;
    state.counters["ratio"] = median(own) / median(peer);
    char text[64];
    std::snprintf(text, sizeof text, "; %.2f of Bullet's time", median(own) / median(peer));
    label += text;
  }
  state.SetLabel(label);
}

const bool registered = [] {
  constexpr Case cases[] = {{"balls", 60},      {"balls", 1000}, {"balls", 10000}, {"ragdolls", 8}, {"ragdolls", 100},
                            {"ragdolls", 1000}, {"pyramid", 20}, {"pyramid", 60},  {"stack", 30},   {"hulls", 100}};
  constexpr Variant variants[] = {{"cpu", Place::cpu, 0, Precision::f32},
                                  {"cpu_1_lane", Place::cpu, 1, Precision::f32},
                                  {"cpu_4_lanes", Place::cpu, 4, Precision::f32},
                                  {"cpu_double", Place::cpu, 0, Precision::f64},
                                  {"gl", Place::gl, 0, Precision::f32}};
  for (const Variant& variant : variants)
    for (const Case& c : cases) {
      const std::string name = std::string("scene/") + c.scene + "_" + std::to_string(c.count) + "/" + variant.name;
      benchmark::RegisterBenchmark(name.c_str(), compare, c, variant)
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  return true;
}();

}  // namespace
