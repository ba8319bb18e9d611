// pcphys run SCENE
#include <iostream>
#include <memory>

#include "commands.h"
#include "event_lines.h"
#include "gltf.h"
#include "output.h"
#include "report.h"
#include "simulation.h"

namespace pcphys::command {
namespace {

struct Files {
  OutputFile json, csv, gltf, events;

  static Result<Files> open(const RunOptions& options) {
    const bool gltf = options.gltf.ends_with(".gltf") || options.gltf.ends_with(".glb");
    if (!options.gltf.empty() && !gltf)
      return Error{ErrorCode::bad_argument,
                   "--gltf is '" + options.gltf + "'; give a file name that ends in .gltf or .glb."};
    Files files;
    OutputFile hash;
    const Status status = open_outputs({{"--json", options.json, files.json},
                                        {"--csv", options.csv, files.csv},
                                        {"--gltf", options.gltf, files.gltf},
                                        {"--events", options.events, files.events},
                                        {"--hash", options.hash ? "-" : "", hash}});
    if (!status) return status.error();
    return files;
  }
};

/// What is noted of each step, where it is wanted.
struct Notes {
  std::unique_ptr<StepRows> rows;
  std::unique_ptr<GltfRecorder> gltf;
  std::unique_ptr<EventLines> events;

  void add(std::uint64_t step, double ms, const StepReport& report, const Simulation& simulation) {
    if (rows) rows->add(step, ms, report);
    if (gltf) gltf->record(simulation.world, step, double(step) * simulation.setup.dt);
    if (events) events->add(step, simulation.stepper.events());
  }
};

/// Steps the simulation, and shows every step to those who want to see it.
Status make_steps(Simulation& simulation, Outcome& outcome, Notes& notes) {
  const Setup& setup = simulation.setup;
  Watch watch(simulation, outcome);
  Progress progress(setup.scene, setup.steps);
  if (notes.gltf) notes.gltf->record(simulation.world, 0, 0);
  for (std::uint64_t step = 1; step <= setup.steps; ++step) {
    const double begin = now();
    const StepReport& report = simulation.stepper.step(simulation.world, setup.dt);
    const double ms = 1000 * (now() - begin);
    if (!report) {
      outcome.last = report;
      return Error{report.error.code,
                   "Step " + std::to_string(step) + " of " + setup.scene + " failed. " + report.error.message};
    }
    outcome.incidents.add(report);
    if (step > setup.warmup) outcome.times.add(ms, report);
    if (step == setup.steps) outcome.last = report;
    notes.add(step, ms, report, simulation);
    watch.after(step);
    progress.show(step);
  }
  outcome.hash = simulation.world.hash();
  return {};
}

Status write_results(const RunOptions& options, Files& files, const Simulation& simulation, const Outcome& outcome,
                     const Notes& notes) {
  if (notes.rows)
    if (auto status = files.csv.write(notes.rows->text()); !status) return status;
  if (notes.events)
    if (auto status = files.events.write(notes.events->text()); !status) return status;
  if (notes.gltf)
    if (auto status = files.gltf.write(notes.gltf->file(options.gltf.ends_with(".glb"))); !status) return status;
  if (files.json)
    if (auto status = files.json.write(to_json(simulation, outcome, options.poses).dump(2) + "\n"); !status)
      return status;
  if (options.hash)
    std::cout << hash_text(outcome.hash) << "\n";
  else if (!files.json && !files.csv.standard_output() && !files.events.standard_output())
    std::cout << to_text(simulation, outcome);
  return {};
}

/// A full buffer is reported in the JSON too, so that a script sees it where it looks for it.
void write_overflow(Files& files, const Simulation& simulation, const Outcome& outcome, const RunOptions& options) {
  if (!files.json) return;
  Json json = to_json(simulation, outcome, options.poses);
  json["overflow"].push_back(outcome.last.error.message);
  if (auto status = files.json.write(json.dump(2) + "\n"); !status) fail(status.error());
}

}  // namespace

int run(const RunOptions& options) {
  const auto setup = resolve(options, 600);
  if (!setup) return fail(setup.error());
  auto files = Files::open(options);
  if (!files) return fail(files.error());
  auto simulation = Simulation::make(*setup);
  if (!simulation) return fail(simulation.error());

  Outcome outcome;
  Notes notes;
  if (files->csv) notes.rows = std::make_unique<StepRows>(*simulation);
  if (files->gltf) notes.gltf = std::make_unique<GltfRecorder>(simulation->scene, setup->steps);
  if (files->events) notes.events = std::make_unique<EventLines>();
  if (auto status = make_steps(*simulation, outcome, notes); !status) {
    if (status.error().code == ErrorCode::buffer_full) write_overflow(*files, *simulation, outcome, options);
    return fail(status.error());
  }
  if (auto status = write_results(options, *files, *simulation, outcome, notes); !status) return fail(status.error());
  const std::string trouble = unsound(outcome);
  if (trouble.empty()) return exit_ok;
  std::cerr << "pcphys: the run of " << setup->scene << " is not sound: " << trouble << ".\n";
  return exit_unsound;
}

}  // namespace pcphys::command
