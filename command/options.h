// What stands on the command line of `run`, `plan` and `tables`, and what it means to the library.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "pcphys/result.h"
#include "pcphys/step.h"
#include "scenes/scene.h"

namespace CLI {
class App;
}

namespace pcphys::command {

/// As they were typed; `resolve` checks them.
struct RunOptions {
  std::string scene;
  std::optional<long long> count, seed;
  std::string backend = "cpu", integrate, joints, impulses;  // a stage that is left empty takes `backend`
  std::string narrow = "native", precision = "float", lanes = "auto", sleep = "off", integrator = "verlet", timings = "on";
  std::string dt = "1/60";
  std::optional<long long> steps;
  long long substeps = 4, threads = 1, warmup = 0, device = -1;
  double ratio = 100;
  std::string json, csv, gltf;
  bool hash = false, poses = false;
};

/// Of `accuracy` and `stability`.
struct CaseOptions {
  std::vector<std::string> names;
  std::string precision = "both", backend = "cpu", dt;
  long long repeats = 1;
  bool all = false, list = false;
  std::string json, csv;
};

/// The options in the library's own terms.
struct Setup {
  std::string scene;
  scenes::SceneOptions scene_options;
  StepSettings settings;
  Precision precision = Precision::f32;
  double dt = 0;
  std::uint64_t steps = 0, warmup = 0;
};

/// Adds SCENE and the options of a run.
void add_scene_argument(CLI::App& app, RunOptions& options);
void add_run_options(CLI::App& app, RunOptions& options);
void add_output_options(CLI::App& app, RunOptions& options);
void add_case_options(CLI::App& app, CaseOptions& options);

// Errors: bad_argument with a sentence that names the option and what it accepts.
Status check_range(const char* option, long long value, long long low, long long high);
Status check_choice(const char* option, const std::string& value, std::initializer_list<const char*> choices);
/// "0.01" or "1/60" [s].
Result<double> time_step(const std::string& text);

/// Errors: bad_argument with a sentence that names the option and what it accepts.
Result<Setup> resolve(const RunOptions& options, std::uint64_t default_steps);

}  // namespace pcphys::command
