#include "simulation.h"

#include <algorithm>
#include <cmath>

#include "step/backend.h"

namespace pcphys::command {
namespace {

constexpr std::size_t small_scene = 3000;  // bodies up to which a sample costs less than a step
constexpr double settling_time = 4;        // before it, limits may be exceeded by the impact [s]

}  // namespace

Result<Simulation> Simulation::make(const Setup& setup) {
  World world({setup.precision});
  auto scene = scenes::make(setup.scene, setup.scene_options, world);
  if (!scene) return scene.error();
  Simulation result{setup, std::move(world), std::move(*scene), Stepper(), 0};
  auto cpu = make_cpu_backend(setup.precision, setup.settings.lanes);
  if (!cpu) return cpu.error();
  result.lanes = (*cpu)->width();
  if (auto status = result.stepper.configure(setup.settings); !status) return status.error();
  if (auto status = scenes::add_kernels(result.scene, result.world, result.stepper); !status) return status.error();
  return result;
}

void Times::add(double ms, const StepReport& report) {
  step.push_back(ms);
  for (std::size_t i = 0; i < timer_count; ++i) stages[i].push_back(report.ms[i]);
}

void Incidents::add(const StepReport& report) {
  most_substeps = std::max(most_substeps, report.substeps);
  repeats += report.repeats;
  given_up += report.given_up;
  limited += report.limited;
  frozen += report.frozen.size();
}

double Times::max_fps() const {
  const auto fps = frames_per_second(step);
  return fps.empty() ? 0 : *std::max_element(fps.begin(), fps.end());
}

double Times::min_fps() const {
  const auto fps = frames_per_second(step);
  return fps.empty() ? 0 : *std::min_element(fps.begin(), fps.end());
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const std::size_t at = std::min(values.size() - 1, std::size_t(share * double(values.size())));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
  return values[at];
}

std::vector<double> frames_per_second(const std::vector<double>& ms) {
  constexpr std::size_t frames = 10;
  std::vector<double> result;
  for (std::size_t i = 0; i < ms.size(); i += frames) {
    const std::size_t end = std::min(ms.size(), i + frames);
    if (end - i < frames && i > 0) break;  // a rest of fewer frames counts only when there is nothing else
    double sum = 0;
    for (std::size_t k = i; k < end; ++k) sum += ms[k];
    result.push_back(1000 * double(end - i) / std::max(sum, 1e-9));
  }
  return result;
}

Watch::Watch(const Simulation& simulation, Outcome& outcome) : simulation_(simulation), outcome_(outcome) {
  outcome.start = scenes::measure(simulation.scene, simulation.world);
  outcome.peaks.energy = outcome.start.energy();
  outcome.peaks.potential_low = outcome.peaks.potential_high = outcome.start.potential;
}

void Watch::after(std::uint64_t step) {
  const World& world = simulation_.world;
  const std::vector<Pose> poses = scenes::poses(simulation_.scene, world);
  rim_.look(simulation_.scene, poses);
  const bool small = simulation_.scene.bodies.size() <= small_scene, last = step == simulation_.setup.steps;
  const std::uint64_t every = small ? 20 : 60;
  Peaks& peaks = outcome_.peaks;
  if (small || last || step % every == 0) {
    const double potential = world.potential_energy();
    peaks.energy = std::max(peaks.energy, potential + world.kinetic_energy());
    peaks.potential_low = std::min(peaks.potential_low, potential);
    peaks.potential_high = std::max(peaks.potential_high, potential);
  }
  if (!simulation_.scene.joints.empty())
    peaks.joint_separation =
        std::max(peaks.joint_separation, scenes::joint_separation(simulation_.scene, world, poses).max);
  if (last) outcome_.end = scenes::measure(simulation_.scene, world, rim_);
  if (!last && step % every != 0) return;
  peaks.penetration = std::max(peaks.penetration, scenes::penetration(simulation_.scene, world, poses).max);
  if (double(step) * simulation_.setup.dt >= settling_time)
    peaks.limit_excess = std::max(peaks.limit_excess, scenes::limit_excess(simulation_.scene, world, poses).any);
}

}  // namespace pcphys::command
