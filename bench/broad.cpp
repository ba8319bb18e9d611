// Broad phase: what an update costs, by the number of proxies, how they lie and how many move.
// One core, times of one update; growth with the number is the fitted complexity.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "collision/pair_cache.h"

namespace {

using namespace pcphys;

enum Layout { uniform, clustered, line, plane, identical, pile };
const char* const layout_names[] = {"uniform", "clustered", "line", "plane", "identical", "pile"};

struct Moves {
  std::mt19937 engine{1};
  float operator()(float from, float to) { return std::uniform_real_distribution<float>(from, to)(engine); }
};

Aabb sphere(float x, float y, float z, float radius) {
  return {{x - radius, y - radius, z - radius}, {x + radius, y + radius, z + radius}};
}

// Spheres of radius 0.5, 2 to 8 fat neighbours each; `identical` has all at one place, so all pairs.
std::vector<Aabb> laid_out(Layout layout, std::size_t count) {
  Moves random;
  std::vector<Aabb> boxes;
  const auto n = static_cast<float>(count);
  const float cube = 0.5f * std::cbrt(n / 0.7f), square = 0.5f * std::sqrt(n / 0.7f);
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(n)));
  for (std::size_t i = 0; i < count; ++i) {
    float x = 0, y = 0, z = 0;
    if (layout == uniform) x = random(-cube, cube), y = random(-cube, cube), z = random(-cube, cube);
    if (layout == plane) x = random(-square, square), z = random(-square, square);
    if (layout == line) x = random(-n, n);
    if (layout == clustered) {  // 16 clusters far apart
      const float small = cube / 2.5f;
      x = 1000 * static_cast<float>(i % 4) + random(-small, small), y = random(-small, small);
      z = 1000 * static_cast<float>(i / 4 % 4) + random(-small, small);
    }
    if (layout == pile) {  // neighbours touch, out of line so that nothing repeats
      x = static_cast<float>(i % side) + random(-0.2f, 0.2f), y = static_cast<float>(i / side / side) * 0.98f;
      z = static_cast<float>(i / side % side) + random(-0.2f, 0.2f);
    }
    boxes.push_back(sphere(x, y, z, 0.5f));
  }
  return boxes;
}

void fill(PairCache& cache, std::size_t count, bool moves) {
  for (std::uint32_t i = 0; i < count; ++i) cache.add(i, moves);
}

void shift(Aabb& box, float by) {
  for (int k = 0; k < 3; ++k) box.min[k] += by, box.max[k] += by;
}

void report(benchmark::State& state, const PairCache& cache, std::size_t moved) {
  state.counters["pairs"] = static_cast<double>(cache.pairs().size());
  state.counters["moved"] = static_cast<double>(moved);
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
}

// A share of the proxies leaves its fat box in every update.
void update(benchmark::State& state, Layout layout, std::size_t per_thousand) {
  const auto count = static_cast<std::size_t>(state.range(0));
  std::vector<Aabb> boxes = laid_out(layout, count);
  PairCache cache;
  fill(cache, count, true);
  if (layout == identical) cache.set_capacity(1u << 26);
  cache.update(boxes);
  std::mt19937 engine(2);
  std::vector<char> moves(count);
  std::size_t moved = 0;
  for (char& m : moves) moved += m = engine() % 1000 < per_thousand;
  float by = 0.12f;
  const auto shake = [&] {
    for (std::size_t i = 0; i < count; ++i)
      if (moves[i]) shift(boxes[i], by);
    by = -by;
  };
  for (int warm = 0; warm < 3; ++warm) shake(), cache.update(boxes);
  for (auto _ : state) {
    state.PauseTiming();
    shake();
    state.ResumeTiming();
    benchmark::DoNotOptimize(cache.update(boxes));
  }
  report(state, cache, moved);
  state.SetLabel(layout_names[layout]);
}

// Nothing leaves its fat box: what a settled or static scene pays.
void settled(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const std::vector<Aabb> boxes = laid_out(pile, count);
  PairCache cache;
  fill(cache, count, true);
  cache.update(boxes);
  for (auto _ : state) benchmark::DoNotOptimize(cache.update(boxes));
  report(state, cache, 0);
}

void build(benchmark::State& state, Layout layout) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const std::vector<Aabb> boxes = laid_out(layout, count);
  std::vector<std::uint32_t> all(count);
  for (std::uint32_t i = 0; i < count; ++i) all[i] = i;
  KdTree tree;
  for (auto _ : state) {
    tree.build(boxes, all);
    benchmark::DoNotOptimize(tree.blocks().data());
  }
  state.SetComplexityN(state.range(0));
  state.SetLabel(std::string(layout_names[layout]) + (tree.wide_codes() ? ", 63-bit codes" : ""));
}

void refit(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const std::vector<Aabb> boxes = laid_out(pile, count);
  std::vector<std::uint32_t> all(count);
  for (std::uint32_t i = 0; i < count; ++i) all[i] = i;
  KdTree tree;
  tree.build(boxes, all);
  for (auto _ : state) tree.refit(boxes);
  state.SetComplexityN(state.range(0));
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->RangeMultiplier(10)->Range(100, 100000)->Unit(benchmark::kMicrosecond)->Complexity();
}
void small_sizes(benchmark::internal::Benchmark* bench) {
  bench->Arg(100)->Arg(300)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond)->Complexity();
}

BENCHMARK_CAPTURE(update, pile_all_move, pile, 1000)->Apply(sizes);
BENCHMARK_CAPTURE(update, pile_5_percent_move, pile, 50)->Apply(sizes);
BENCHMARK_CAPTURE(update, uniform_all_move, uniform, 1000)->Apply(sizes);
BENCHMARK_CAPTURE(update, clustered_all_move, clustered, 1000)->Apply(sizes);
BENCHMARK_CAPTURE(update, line_all_move, line, 1000)->Apply(sizes);
BENCHMARK_CAPTURE(update, plane_all_move, plane, 1000)->Apply(sizes);
BENCHMARK_CAPTURE(update, identical_all_move, identical, 1000)->Apply(small_sizes);
BENCHMARK(settled)->Apply(sizes);
BENCHMARK(refit)->Apply(sizes);
BENCHMARK_CAPTURE(build, uniform, uniform)->Apply(sizes);
BENCHMARK_CAPTURE(build, clustered, clustered)->Apply(sizes);
BENCHMARK_CAPTURE(build, line, line)->Apply(sizes);
BENCHMARK_CAPTURE(build, plane, plane)->Apply(sizes);
BENCHMARK_CAPTURE(build, identical, identical)->Apply(sizes);

}  // namespace
