// What stands on the command line of `accuracy` and `stability`.
#include <CLI/CLI.hpp>

#include "cases/runner.h"
#include "options.h"

namespace pcphys::command {

void add_case_options(CLI::App& app, CaseOptions& options) {
  app.add_option("CASE", options.names, "names of cases; all when none is given");
  app.add_flag("--list", options.list, "list the cases and their variants");
  app.add_flag("--all", options.all, "the step lengths that take minutes too");
  app.add_option("--variant", options.variant,
                 "only the variant of this name, as --list shows it; where none has it, those whose names start so");
  app.add_option("--precision", options.precision, "float, double or both")->capture_default_str();
  app.add_option("--dt", options.dt, "this step length only [s], also as a fraction");
  app.add_option("--backend", options.backend,
                 "gl: run the first 600 steps of everything there too, and compare hashes")
      ->capture_default_str();
  app.add_flag("--first", options.first, "with --backend gl: those 600 steps alone, for the hashes; no errors");
  add_device(app, options.device);
  app.add_option("--repeats", options.repeats, "runs that a time is the median of; what takes over 0.3 s runs once")
      ->capture_default_str();
  app.add_option("--peers", options.peers, "other engines beside pcphys: all, none, or names with commas between")
      ->capture_default_str();
  app.add_option("--budget", options.budget, "a trial of a peer that takes longer is given up [s]")
      ->capture_default_str();
  app.add_option("--json", options.json, "write the rows to this file; - is standard output");
  app.add_option("--csv", options.csv, "write the rows as a table to this file");
}

Result<cases::Selection> resolve(const CaseOptions& options, const std::string& groups) {
  cases::Selection selection;
  selection.groups = groups;
  selection.names = options.names;
  selection.variant = options.variant;
  selection.slow = options.all;
  selection.coarse = true;
  if (auto status = check_choice("precision", options.precision, {"float", "double", "both"}); !status)
    return status.error();
  if (auto status = check_choice("backend", options.backend, {"cpu", "gl"}); !status) return status.error();
  if (auto status = check_range("device", options.device, -1, 1000); !status) return status.error();
  if (auto status = check_range("repeats", options.repeats, 1, 1000); !status) return status.error();
  selection.single = options.precision != "double";
  selection.twice = options.precision != "float";
  selection.gl = options.backend == "gl";
  selection.first = options.first;
  selection.device = int(options.device);
  if (selection.first && !selection.gl)
    return Error{ErrorCode::bad_argument, "--first compares the first 600 steps of cpu and gl; it needs --backend gl."};
  selection.repeats = int(options.repeats);
  if (!options.dt.empty()) {
    const auto dt = time_step(options.dt);
    if (!dt) return dt.error();
    selection.dt = *dt;
  }
  return selection;
}

}  // namespace pcphys::command
