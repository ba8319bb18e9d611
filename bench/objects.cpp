// What a host pays for objects: to make and destroy bodies that touch, one by one and many at once, with sleep and
// without, and the memory of a ball. Times and bytes are of one body.
#include <benchmark/benchmark.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <vector>

#include "pcphys/pcphys.h"

namespace {

using namespace pcphys;
using benchmark::Counter;

BodyDef ball(Vec3 position) {
  BodyDef def;
  def.shapes = {ShapeDef::sphere(0.5)};
  def.pose.position = position;
  return def;
}

/// Balls in a cube, neighbours touching, on a floor.
struct Heap {
  World world;
  std::vector<BodyId> balls;

  explicit Heap(std::int64_t count) {
    BodyDef floor;
    floor.kind = BodyKind::fixed;
    floor.shapes = {ShapeDef::plane()};
    (void)world.create_body(floor);
    const std::int64_t side = std::int64_t(std::ceil(std::cbrt(double(count))));
    for (std::int64_t i = 0; i < count; i++) {
      const double x = double(i % side), y = double(i / side / side), z = double(i / side % side);
      balls.push_back(*world.create_body(ball({0.999 * x, 0.499 + 0.999 * y, 0.999 * z})));
    }
  }
  void step(bool sleep, int steps) {
    StepSettings settings;
    settings.sleep = sleep;
    settings.sleep_speed = settings.sleep_spin = sleep ? 100 : settings.sleep_speed;  // all of it falls asleep
    settings.sleep_time = 1.0 / 60;
    Stepper stepper(settings);
    for (int i = 0; i < steps; i++)
      if (const StepReport& report = stepper.step(world, 1.0 / 60); !report) std::abort();
  }
};

void per_body(benchmark::State& state) {
  state.counters["each"] = Counter(double(state.range(0)), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void make(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Heap(state.range(0)));
  per_body(state);
}

enum Way { one_by_one, at_random, together };
/// All of them, after steps in which they touched, and where `sleep` fell asleep.
void destroy(benchmark::State& state, Way way, bool sleep) {
  for (auto _ : state) {
    state.PauseTiming();
    Heap heap(state.range(0));
    heap.step(sleep, 3);
    if (way == at_random) std::ranges::shuffle(heap.balls, std::mt19937(1));
    state.ResumeTiming();
    if (way == together)
      (void)heap.world.destroy(heap.balls);
    else
      for (const BodyId id : heap.balls) (void)heap.world.destroy(id);
    benchmark::DoNotOptimize(heap.world.contact_count());
    state.PauseTiming();
    heap = Heap(1);
    state.ResumeTiming();
  }
  per_body(state);
}

/// Of a thousand made in a world that sleeps.
void make_beside_sleepers(benchmark::State& state) {
  Heap heap(state.range(0));
  heap.step(true, 3);
  for (auto _ : state) {
    std::vector<BodyId> made;
    for (int i = 0; i < 1000; i++) made.push_back(*heap.world.create_body(ball({-10.0 - i, 5, 0})));
    state.PauseTiming();
    (void)heap.world.destroy(made);
    state.ResumeTiming();
  }
  state.counters["each"] = Counter(1000, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

double allocated() {
  const auto info = mallinfo2();
  return double(info.uordblks + info.hblkhd);
}
/// Pages that are there [bytes].
double resident() {
  malloc_trim(0);
  std::ifstream pages("/proc/self/statm");
  double all = 0, here = 0;
  pages >> all >> here;
  return here * double(sysconf(_SC_PAGESIZE));
}
/// Balls in a cube that is turned against the axes, so that boxes overlap as in a pile: each touches six, and its box
/// those of five more. Further from each other they touch nothing. They float.
World floating_cube(std::int64_t count, double distance) {
  WorldDef def;
  def.gravity = {};
  World world(def);
  const Quat turned{0.1, 0.3, 0.5, std::sqrt(0.65)};
  const std::int64_t side = std::int64_t(std::ceil(std::cbrt(double(count))));
  for (std::int64_t i = 0; i < count; i++) {
    const Vec3 place{double(i % side), double(i / side / side), double(i / side % side)};
    if (!world.create_body(ball(rotate(turned, distance * place)))) std::abort();
  }
  return world;
}
/// Bytes a ball after steps: allocated, resident, and the share that the library accounts for.
void memory(benchmark::State& state, double distance) {
  for (auto _ : state) {
    const double allocated_before = allocated(), resident_before = resident(), count = double(state.range(0));
    World world = floating_cube(state.range(0), distance);
    Stepper stepper;
    for (int i = 0; i < 10; i++)
      if (const StepReport& report = stepper.step(world, 1.0 / 60); !report) std::abort();
    const double gained = allocated() - allocated_before;
    double told = 0;
    for (const BufferUse& use : stepper.memory(world)) told += double(use.bytes);
    state.counters["allocated"] = gained / count;
    state.counters["resident"] = (resident() - resident_before) / count;
    state.counters["told"] = told / gained;
    state.counters["contacts"] = double(world.contact_count()) / count;
  }
}

constexpr std::int64_t few = 1000, many = 100000;
BENCHMARK(make)->RangeMultiplier(10)->Range(few, many)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(destroy, one_by_one, one_by_one, false)
    ->RangeMultiplier(10)
    ->Range(few, many)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(destroy, at_random, at_random, false)
    ->RangeMultiplier(10)
    ->Range(few, many)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(destroy, asleep, at_random, true)
    ->RangeMultiplier(10)
    ->Range(few, many)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(make_beside_sleepers)->RangeMultiplier(10)->Range(few, many)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(memory, touching, 0.9999)
    ->RangeMultiplier(10)
    ->Range(few, many)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(memory, apart, 1.2)
    ->RangeMultiplier(10)
    ->Range(few, many)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
