// Colouring of a contact graph from scratch, and its slots, on one core.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "plan/coloring.h"

namespace {

using namespace pcphys;

struct Graph {
  std::uint32_t unit_count = 0;
  std::vector<std::uint32_t> units, priorities, rows;
};

// A pile on a grid: each body touches its neighbours along three axes and some diagonals, the lowest layer
// the fixed ground.
Graph pile(std::uint32_t constraints) {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::cbrt(constraints / 3.6)));
  Graph graph;
  graph.unit_count = side * side * side;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    if (graph.rows.size() >= constraints) return;
    graph.units.push_back(a);
    graph.units.push_back(b);
    graph.priorities.push_back(priority(a, b, 0));
    graph.rows.push_back(static_cast<std::uint32_t>(graph.rows.size()) + 1);
  };
  for (std::uint32_t i = 0; i < graph.unit_count; ++i) {
    const std::uint32_t x = i % side, z = i / side % side, y = i / side / side;
    if (y == 0) add(i, Colouring::fixed_unit);
    if (x + 1 < side) add(i, i + 1);
    if (z + 1 < side) add(i, i + side);
    if (y + 1 < side) add(i, i + side * side);
    if (x + 1 < side && y + 1 < side) add(i, i + 1 + side * side);
  }
  return graph;
}

void colour(benchmark::State& state) {
  const Graph graph = pile(static_cast<std::uint32_t>(state.range(0)));
  Colouring colouring;
  for (auto _ : state) {
    colouring.build(graph.unit_count, graph.units, graph.priorities);
    benchmark::DoNotOptimize(colouring.list().data());
  }
  state.counters["constraints"] = static_cast<double>(graph.rows.size());
  state.counters["colours"] = colouring.colours();
  state.SetComplexityN(state.range(0));
}

void pack(benchmark::State& state) {
  Graph graph = pile(static_cast<std::uint32_t>(state.range(0)));
  Colouring colouring;
  colouring.build(graph.unit_count, graph.units, graph.priorities);
  Slots slots;
  for (auto _ : state) {
    pack_slots(colouring, 8, graph.units, graph.rows, slots);
    benchmark::DoNotOptimize(slots.ends.data());
  }
  state.SetComplexityN(state.range(0));
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Arg(50)->Arg(500)->Arg(5000)->Arg(50000)->Arg(500000)->Unit(benchmark::kMicrosecond)->Complexity();
}
BENCHMARK(colour)->Apply(sizes);
BENCHMARK(pack)->Apply(sizes);

}  // namespace
