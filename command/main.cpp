// The command pcphys: one program over the library. docs/command.md is its contract.
#include <CLI/CLI.hpp>
#include <exception>
#include <new>

#include "commands.h"
#include "output.h"
#include "pcphys/fcl.h"
#include "pcphys/version.h"

using namespace pcphys::command;

namespace {

int usage_error(const std::string& message) {
  print_error(message + (message.ends_with(".") ? "" : ".") + " `pcphys --help` tells what there is.");
  return exit_usage;
}

void add_report_options(CLI::App& app, OutputOptions& options) {
  app.add_option("--json", options.json, "write the result to this file; - is standard output");
  app.add_option("--csv", options.csv, "write a table to this file");
}

int command_line(int argc, char** argv) {
  CLI::App app{"pcphys: physics with one source for CPU and GPU", "pcphys"};
  app.set_version_flag("--version", "pcphys " PCPHYS_VERSION);
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every sub-command");

  (void)pcphys::use_fcl();  // for --narrow fcl; a build without it says so when it is asked for

  RunOptions run_options;
  OutputOptions output_options;
  CLI::App* run_command = app.add_subcommand("run", "run a scene and measure it");
  CLI::App* plan_command =
      app.add_subcommand("plan", "print what a step of a scene runs and leaves out; --steps K makes K steps before");
  CLI::App* tables_command = app.add_subcommand("tables", "Tables 1 and 2 of the original, with what is measured here");
  CLI::App* scenes_command = app.add_subcommand("scenes", "list the scenes");
  CLI::App* doctor_command = app.add_subcommand("doctor", "tell what this machine offers and what is missing");
  for (CLI::App* command : {run_command, plan_command}) add_scene_argument(*command, run_options);
  for (CLI::App* command : {run_command, plan_command, tables_command}) {
    add_run_options(*command, run_options);
    add_output_options(*command, run_options);
  }
  run_command->add_option("--events", run_options.events,
                          "write what happened in each step to this file, a line of JSON an event");
  run_command->add_option("--gltf", run_options.gltf, "write the motion as glTF 2.0 to this file (.gltf or .glb)");
  run_command->add_flag("--hash", run_options.hash, "print nothing but the hash of the final state");
  run_command->add_flag("--poses", run_options.poses, "add the final pose and velocity of every body to the JSON");
  for (CLI::App* command : {scenes_command, doctor_command}) add_report_options(*command, output_options);
  CaseOptions case_options;
  CLI::App* accuracy_command = app.add_subcommand("accuracy", "errors against motion that is known, and what they must reach");
  CLI::App* stability_command = app.add_subcommand("stability", "stiff and extreme cases, and what they must reach");
  for (CLI::App* command : {accuracy_command, stability_command}) add_case_options(*command, case_options);
  CompareOptions compare_options;
  CLI::App* compare_command = app.add_subcommand("compare", "scenes in pcphys and in other engines, in the same run");
  add_compare_options(*compare_command, compare_options);
  add_scene_options(*compare_command, run_options);
  add_run_options(*compare_command, run_options);
  add_output_options(*compare_command, run_options);

  WildOptions wild_options;
  CLI::App* wild_command = app.add_subcommand("wild", "random scenes, and what holds in all of them");
  add_wild_options(*wild_command, wild_options);
  for (CLI::App* command : app.get_subcommands({})) check_values(*command);

  const auto is_first_word = [&](CLI::App* command) { return command->check_name(argv[1]); };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_first_word).empty())
    return usage_error("There is no sub-command '" + std::string(argv[1]) + "'.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return usage_error(error.what());
  }
  if (*run_command) return run(run_options);
  if (*plan_command) return plan(run_options);
  if (*tables_command) return tables(run_options);
  if (*scenes_command) return scenes_list(output_options);
  if (*doctor_command) return doctor(output_options);
  if (*accuracy_command) return run_cases(case_options, "accuracy", "A");
  if (*stability_command) return run_cases(case_options, "stability", "BC");
  if (*compare_command) return compare(compare_options, run_options);
  if (*wild_command) return wild(wild_options);
  return usage_error("A sub-command is missing.");
}

}  // namespace

int main(int argc, char** argv) {
  guard_streams();
  int code = exit_failed;
  try {
    code = command_line(argc, argv);
  } catch (const std::bad_alloc&) {
    print_error("This machine has not enough memory for that; ask for fewer objects or steps.");
  } catch (const std::exception& error) {
    print_error(std::string("An error of pcphys itself, which its authors should know of: ") + error.what() + ".");
  }
  return finish_streams(code);
}
