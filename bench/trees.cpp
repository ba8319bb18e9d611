// Joint trees of which no two are alike, so that each stands alone in its block: on the CPU in scalars, on GL with one
// invocation a tree and with a work group that shares it. Nothing touches; 4 sub-steps of 1/60 s. The time of a
// benchmark is the median step.
//   tree/WORLD/TREES/VARIANT      PCPHYS_BENCH_STEPS=100 for a quick look
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>

#include "pcphys/step.h"
#include "scenes/balls_on_joints.h"
#include "step/backend.h"

namespace {

using namespace pcphys;

int step_count() {
  const char* text = std::getenv("PCPHYS_BENCH_STEPS");
  return text ? std::max(1, std::atoi(text)) : 300;
}

/// 15 to 60 bodies each.
scenes::Parents unlike(std::uint32_t i, scenes::Random& random) { return scenes::drawn_tree(15 + i * 7 % 46, random); }
scenes::Parents bush(std::uint32_t, scenes::Random& random) { return scenes::drawn_tree(1000, random); }
scenes::Parents chain(std::uint32_t, scenes::Random&) { return scenes::chain_tree(100); }
scenes::Parents star(std::uint32_t, scenes::Random&) { return scenes::star_tree(200); }

struct Case {
  const char* name;
  std::uint32_t trees;
  scenes::Parents (*shape)(std::uint32_t i, scenes::Random& random);
};
struct Variant {
  const char* name;
  Place place;
  std::uint32_t team;
};

Status build(World& world, const Case& c) {
  scenes::Random random(1);
  if (Status status = world.set_gravity({}); !status) return status;
  for (std::uint32_t i = 0; i < c.trees; i++) {
    scenes::TreeOfBalls tree;
    tree.place = {10.0 * (i % 32), 0, 10.0 * (i / 32)};
    tree.group = std::int32_t(i + 1);
    if (const auto made = scenes::add_balls(world, c.shape(i, random), tree, random); !made) return made.error();
  }
  return {};
}

void step(benchmark::State& state, Case c, Variant variant) {
  World world;
  if (const Status status = build(world, c); !status) return state.SkipWithError(status.error().message.c_str());
  gl_team().size = variant.team;
  StepSettings settings;
  settings.set_all(variant.place);
  settings.timings = false;
  Stepper stepper(settings);
  Error error;
  std::vector<double> seconds;
  for (auto _ : state) {
    for (int i = 0; i < step_count() + 3 && error.code == ErrorCode::none; i++) {  // the first compile programs
      const auto begin = std::chrono::steady_clock::now();
      error = stepper.step(world, 1.0 / 60).error;
      if (i >= 3) seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    if (error.code != ErrorCode::none) return state.SkipWithError(error.message.c_str());
    std::ranges::nth_element(seconds, seconds.begin() + std::ptrdiff_t(seconds.size() / 2));
    state.SetIterationTime(seconds[seconds.size() / 2]);
  }
  state.SetLabel(stepper.device(variant.place) + ", hash " + std::to_string(world.hash()));
}

const bool registered = [] {
  constexpr Case cases[] = {{"unlike", 10, unlike}, {"unlike", 100, unlike}, {"unlike", 1000, unlike},
                            {"bush_1000", 1, bush}, {"chain_100", 1, chain}, {"star_200", 1, star}};
  constexpr Variant variants[] = {
      {"cpu", Place::cpu, 1}, {"gl_alone", Place::gl, 1}, {"gl_team_8", Place::gl, 8}, {"gl_team_32", Place::gl, 32}};
  for (const Case& c : cases)
    for (const Variant& variant : variants)
      benchmark::RegisterBenchmark(
          (std::string("tree/") + c.name + "/" + std::to_string(c.trees) + "/" + variant.name).c_str(), step, c,
          variant)
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMicrosecond);
  return true;
}();

}  // namespace
