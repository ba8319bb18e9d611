// A scene in a world with a stepper, and the figures that a run of it gathers.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "options.h"
#include "pcphys/step.h"
#include "pcphys/world.h"
#include "scenes/metrics.h"

namespace pcphys::command {

inline constexpr std::size_t timer_count = std::size_t(Timer::count);

struct Simulation {
  Setup setup;
  World world;
  scenes::Scene scene;
  Stepper stepper;
  std::uint32_t lanes = 0;  // that the CPU uses

  /// Errors: those of the scene, and of what the settings ask for that is not on this machine.
  static Result<Simulation> make(const Setup& setup);
};

/// Times of the steps after the warm-up.
struct Times {
  std::vector<double> step;                             // [ms]
  std::array<std::vector<double>, timer_count> stages;  // [ms]

  void add(double ms, const StepReport& report);
  double max_fps() const;
  double min_fps() const;
};

/// The value below which a share of the values lies; 0 when there is none.
double quantile(std::vector<double> values, double share);
inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }
/// Frames per second over the mean of every ten frames, as in the original.
std::vector<double> frames_per_second(const std::vector<double>& ms);

/// Extremes along a run, sampled beside it.
struct Peaks {
  double penetration = 0, joint_separation = 0, limit_excess = 0;  // the last one from 4 s on
  double energy = 0, potential_low = 0, potential_high = 0;
};

/// What steps did beside moving on, over the run: sums of StepReport's counts, and its largest sub-steps.
struct Incidents {
  std::uint32_t most_substeps = 0;
  std::uint64_t repeats = 0, given_up = 0;  // times, steps
  std::uint64_t limited = 0, frozen = 0;    // bodies, once a step

  void add(const StepReport& report);
};

/// What is known after a run.
struct Outcome {
  Times times;
  scenes::Metrics start, end;
  Peaks peaks;
  Incidents incidents;
  StepReport last;
  std::uint64_t hash = 0;
};

/// Samples the extremes, and measures the end: joint gaps at every step, the energy too of a small scene, overlaps and
/// limits every 20 steps (60 of a large one).
class Watch {
 public:
  Watch(const Simulation& simulation, Outcome& outcome);
  void after(std::uint64_t step);

 private:
  const Simulation& simulation_;
  Outcome& outcome_;
  scenes::RimWatch rim_;
};

}  // namespace pcphys::command
