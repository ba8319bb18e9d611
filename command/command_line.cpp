#include "command_line.h"

#include <CLI/CLI.hpp>
#include <sstream>

#include "pcphys/version.h"

namespace pcphys::command {
namespace {

void add_report_options(CLI::App& app, OutputOptions& options) {
  app.add_option("--json", options.json, "write the result to this file; - is standard output");
  app.add_option("--csv", options.csv, "write a table to this file");
}

void add_commands(CLI::App& app, CommandLine& line) {
  CLI::App* run_command = app.add_subcommand("run", "run a scene and measure it");
  CLI::App* plan_command =
      app.add_subcommand("plan", "print what a step of a scene runs and leaves out; --steps K makes K steps before");
  CLI::App* tables_command = app.add_subcommand("tables", "Tables 1 and 2 of the original, with what is measured here");
  CLI::App* scenes_command = app.add_subcommand("scenes", "list the scenes");
  CLI::App* doctor_command = app.add_subcommand("doctor", "tell what this machine offers and what is missing");
  for (CLI::App* command : {run_command, plan_command}) add_scene_argument(*command, line.run);
  for (CLI::App* command : {run_command, plan_command, tables_command}) {
    add_run_options(*command, line.run);
    add_output_options(*command, line.run);
  }
  run_command->add_option("--events", line.run.events,
                          "write what happened in each step to this file, a line of JSON an event");
  run_command->add_option("--gltf", line.run.gltf, "write the motion as glTF 2.0 to this file (.gltf or .glb)");
  run_command->add_flag("--hash", line.run.hash, "print nothing but the hash of the final state");
  run_command->add_flag("--poses", line.run.poses, "add the final pose and velocity of every body to the JSON");
  for (CLI::App* command : {scenes_command, doctor_command}) add_report_options(*command, line.output);
  CLI::App* accuracy_command =
      app.add_subcommand("accuracy", "errors against motion that is known, and what they must reach");
  CLI::App* stability_command = app.add_subcommand("stability", "stiff and extreme cases, and what they must reach");
  for (CLI::App* command : {accuracy_command, stability_command}) add_case_options(*command, line.cases);
  CLI::App* compare_command = app.add_subcommand("compare", "scenes in pcphys and in other engines, in the same run");
  add_compare_options(*compare_command, line.compare);
  add_scene_options(*compare_command, line.run);
  add_run_options(*compare_command, line.run);
  add_output_options(*compare_command, line.run);
  CLI::App* wild_command = app.add_subcommand("wild", "random scenes, and what holds in all of them");
  add_wild_options(*wild_command, line.wild);
  for (CLI::App* command : app.get_subcommands({})) check_values(*command);
}

}  // namespace

Result<CommandLine> read_command_line(int argc, const char* const* argv) {
  CommandLine line;
  CLI::App app{"pcphys: physics with one source for CPU and GPU", "pcphys"};
  app.set_version_flag("--version", "pcphys " PCPHYS_VERSION);
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every sub-command");
  add_commands(app, line);

  const auto is_first_word = [&](CLI::App* command) { return command->check_name(argv[1]); };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_first_word).empty())
    return Error{ErrorCode::bad_argument, "There is no sub-command '" + std::string(argv[1]) + "'."};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return Error{ErrorCode::bad_argument, error.what()};
    std::ostringstream text;
    app.exit(error, text, text);
    line.help = text.str();
    return line;
  }
  line.command = app.get_subcommands().front()->get_name();
  return line;
}

}  // namespace pcphys::command
