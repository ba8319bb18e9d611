// The same scene three times: on the CPU; moving from place to place in mid-run, every stage for itself; and
// with the narrowest lanes. All end in the same bits.
#include <cstdio>

#include "pcphys/pcphys.h"
#include "scenes/scene.h"

using namespace pcphys;

namespace {

constexpr int steps = 240;

/// Hash at the end; 0 after an error. `choose` sets what the next step uses.
template <class Choose> std::uint64_t run(const char* label, Choose choose) {
  World world;
  scenes::SceneOptions options;
  options.count = 4;
  if (!scenes::make("ragdolls", options, world)) return 0;
  Stepper stepper;
  StepSettings settings;
  for (int step = 0; step < steps; ++step) {
    choose(step, settings);
    if (const Status status = stepper.configure(settings); !status) return std::puts(status.error().message.c_str()), 0;
    if (const StepReport& report = stepper.step(world, 1.0 / 60); !report)
      return std::puts(report.error.message.c_str()), 0;
  }
  std::printf("%-30s 0x%016llx\n", label, (unsigned long long)world.hash());
  return world.hash();
}

}  // namespace

int main() {
  const std::uint64_t still = run("cpu", [](int, StepSettings&) {});
  const std::uint64_t narrow = run("cpu, one lane", [](int, StepSettings& s) { s.lanes = 1; });
  std::uint64_t moving = still;
  if (const GlReport gl = probe_gl(-1); gl.usable) {
    moving = run("a new mix every 30 steps", [](int step, StepSettings& s) {
      const int mix = step / 30 % 8;
      s.integrate = mix & 1 ? Place::gl : Place::cpu;
      s.joints = mix & 2 ? Place::gl : Place::cpu;
      s.impulses = mix & 4 ? Place::gl : Place::cpu;
    });
  } else {
    std::printf("no OpenGL here, so only lanes are compared: %s\n", gl.problem.c_str());
  }
  return still != 0 && still == narrow && still == moving ? 0 : 1;
}
