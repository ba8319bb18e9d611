// What stands on the command line of each sub-command, and what it means to the library.
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
namespace pcphys::cases {
struct Selection;
}
namespace pcphys::wild {
struct RunOptions;
}

namespace pcphys::command {

/// Options that several sub-commands have.
void add_lanes_and_threads(CLI::App& app, std::string& lanes, long long& threads);
void add_device(CLI::App& app, long long& device);

/// As they were typed; `resolve` checks them.
struct RunOptions {
  std::string scene;
  std::optional<long long> count, seed;
  std::string backend = "cpu", integrate, joints, impulses;  // a stage that is left empty takes `backend`
  std::string islands = "cpu";
  std::string narrow = "native", precision = "float", lanes = "auto", sleep = "off", integrator = "verlet",
              timings = "on";
  std::string dt = "1/60";
  std::optional<long long> steps;
  long long substeps = 4, order = 2, threads = 1, warmup = 0, device = -1;
  double ratio = 100;
  std::optional<double> friction, restitution, drag, joint_damping;
  std::string json, csv, gltf, events;
  bool hash = false, poses = false, resident = false;
};

/// Of `accuracy` and `stability`.
struct CaseOptions {
  std::vector<std::string> names;
  std::string variant, precision = "both", backend = "cpu", dt;
  long long repeats = 1;
  std::string peers = "none";
  double budget = 5;  // of stepping, for each trial of a peer [s]
  bool all = false, list = false, first = false;
  long long device = -1;
  std::string json, csv;
};

/// Of `compare`, beside those of a run.
struct CompareOptions {
  std::vector<std::string> scenes;  // "balls" or "balls:1000"; none: all
  std::string peers;                // empty: `compare` chooses
  long long peer_substeps = 0, peer_iterations = 0;
  double budget = 20;  // of stepping, for each peer and scene [s]
};

/// Of `wild`.
struct WildOptions {
  std::vector<std::string> families;
  std::optional<long long> seed, count;
  std::optional<double> budget;  // of all [s]
  std::string precision = "float", backend = "cpu", lanes = "auto", peers = "none";
  long long threads = 1, bits = 16, bits_gl = 0;
  bool list = false, shrink = false;
  std::string shrink_to, json, csv;
};

/// Of `scenes` and `doctor`.
struct OutputOptions {
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
void add_scene_options(CLI::App& app, RunOptions& options);
void add_run_options(CLI::App& app, RunOptions& options);
void add_output_options(CLI::App& app, RunOptions& options);
void add_case_options(CLI::App& app, CaseOptions& options);
void add_compare_options(CLI::App& app, CompareOptions& options);
void add_wild_options(CLI::App& app, WildOptions& options);
/// To be called when all options are there: refuses empty values of any, and of numbers what is not one from end to end
/// or has no place in 64 bits.
void check_values(CLI::App& app);

// Errors: bad_argument with a sentence that names the option and what it accepts.
Status check_range(const char* option, long long value, long long low, long long high);
Status check_choice(const char* option, const std::string& value, std::initializer_list<const char*> choices);
Status check_budget(double seconds);
/// Names of peers with commas between; all or none. Those that were not found are among them. Errors: unknown_name.
Result<std::vector<std::string>> peer_names(const std::string& list);
/// Those of the list that were found. With "all" the others are named on standard error; asked for by name, one that
/// was not found is an error.
Result<std::vector<std::string>> found_peers(const std::string& list);
/// "0.01" or "1/60" [s].
Result<double> time_step(const std::string& text);

/// A scene of `compare`.
struct SceneEntry {
  std::string scene;
  std::optional<long long> count;
};
/// "balls" or "balls:1000".
Result<SceneEntry> scene_of(const std::string& text);
/// One scene of each family, of which every measure is told.
bool single(const WildOptions& options);

// Errors: bad_argument with a sentence that names the option and what it accepts; of peers as `found_peers`. Whether
// there are such scenes, cases, families and devices is looked at when they are wanted.
Result<Setup> resolve(const RunOptions& options, std::uint64_t default_steps);
/// Of the cases of these groups.
Result<cases::Selection> resolve(const CaseOptions& options, const std::string& groups);
Result<wild::RunOptions> resolve(const WildOptions& options);
Status check(const CompareOptions& options);

}  // namespace pcphys::command
