// Where the time of a step goes: the median of every stage over two seconds of falling balls.
#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "pcphys/pcphys.h"
#include "scenes/scene.h"

using namespace pcphys;

int main() {
  World world;
  scenes::SceneOptions options;
  options.count = 300;
  if (!scenes::make("balls", options, world)) return 1;

  Stepper stepper;
  constexpr std::size_t timers = std::size_t(Timer::count);
  std::array<std::vector<double>, timers + 1> times;  // the last one: the whole step
  for (int step = 0; step < 120; ++step) {
    const StepReport& report = stepper.step(world, 1.0 / 60);
    if (!report) return std::puts(report.error.message.c_str()), 1;
    for (std::size_t i = 0; i < timers; ++i) times[i].push_back(report.ms[i]);
    times[timers].push_back(report.total_ms);
  }

  double sum = 0, total = 0;
  for (std::size_t i = 0; i <= timers; ++i) {
    std::sort(times[i].begin(), times[i].end());
    const double median = times[i][times[i].size() / 2];
    std::printf("%-10s %8.4f ms\n", i < timers ? name(Timer(i)) : "step", median);
    (i < timers ? sum : total) += median;
  }
  return sum > 0.3 * total && sum < 1.3 * total ? 0 : 1;
}
