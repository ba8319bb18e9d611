// What a step costs where everything sleeps, all but one body, or nothing: a pyramid of 60 (1,830 boxes) after 5 s of
// 1/60 s, beside a ball in flight that may not sleep, pcphys and Bullet with its own thresholds.
//   sleep/pyramid_60/STATE/ENGINE
#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "pcphys/step.h"
#include "peers/peer.h"
#include "scenes/scene.h"

namespace {

using namespace pcphys;

constexpr double dt = 1.0 / 60;
constexpr int settle = 300;  // steps
enum class Awake { none, one, all };

/// The scene, and where one is to stay awake a ball that flies about far off, without gravity's help.
struct Pile {
  World world;
  std::vector<BodyId> ids;
  Error error;

  explicit Pile(Awake awake) {
    scenes::SceneOptions options;
    options.count = 60;
    const auto scene = scenes::make("pyramid", options, world);
    if (!scene) {
      error = scene.error();
      return;
    }
    for (const scenes::SceneBody& body : scene->bodies) ids.push_back(body.id);
    if (awake != Awake::one) return;
    BodyDef def;
    def.shapes = {ShapeDef::sphere(0.5)};
    def.pose.position = {0, 1e5, 0};
    def.can_sleep = false;
    const auto ball = world.create_body(def);
    if (ball) ids.push_back(*ball);
  }
};

void pcphys_step(benchmark::State& state, Awake awake) {
  Pile pile(awake);
  StepSettings settings;
  settings.timings = false;
  settings.sleep = awake != Awake::all;
  Stepper stepper(settings);
  Error error = pile.error;
  for (int i = 0; i < settle && error.code == ErrorCode::none; i++) error = stepper.step(pile.world, dt).error;
  std::uint32_t asleep = 0;
  for (auto _ : state)
    if (error.code == ErrorCode::none) {
      const StepReport& report = stepper.step(pile.world, dt);
      error = report.error;
      asleep = report.asleep;
    }
  if (error.code != ErrorCode::none) return state.SkipWithError(error.message.c_str());
  state.counters["asleep"] = asleep;
}

void bullet_step(benchmark::State& state, Awake awake) {
  Pile pile(awake);
  peers::Options options;
  options.sleep = awake != Awake::all;
  const auto bullet = peers::make("bullet", pile.world, pile.ids, options);
  if (!bullet) return state.SkipWithError(bullet.error().message.c_str());
  for (int i = 0; i < settle; i++) (void)(*bullet)->step(dt);
  for (auto _ : state) (void)(*bullet)->step(dt);
}

const bool registered = [] {
  constexpr struct {
    const char* name;
    Awake awake;
  } states[] = {{"all_asleep", Awake::none}, {"one_awake", Awake::one}, {"all_awake", Awake::all}};
  for (const auto& s : states) {
    const std::string name = std::string("sleep/pyramid_60/") + s.name;
    benchmark::RegisterBenchmark((name + "/pcphys").c_str(), pcphys_step, s.awake)->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark((name + "/bullet").c_str(), bullet_step, s.awake)->Unit(benchmark::kMicrosecond);
  }
  return true;
}();

}  // namespace
