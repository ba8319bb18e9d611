// The command pcphys: one program over the library. docs/command.md is its contract.
#include <exception>
#include <iostream>
#include <new>

#include "command_line.h"
#include "commands.h"
#include "output.h"
#include "pcphys/fcl.h"

using namespace pcphys::command;

namespace {

int usage_error(const std::string& message) {
  print_error(message + (message.ends_with(".") ? "" : ".") + " `pcphys --help` tells what there is.");
  return exit_usage;
}

int command_line(int argc, char** argv) {
  (void)pcphys::use_fcl();  // for --narrow fcl; a build without it says so when it is asked for
  const auto line = read_command_line(argc, argv);
  if (!line) return usage_error(line.error().message);
  std::cout << line->help;
  if (line->command == "run") return run(line->run);
  if (line->command == "plan") return plan(line->run);
  if (line->command == "tables") return tables(line->run);
  if (line->command == "scenes") return scenes_list(line->output);
  if (line->command == "doctor") return doctor(line->output);
  if (line->command == "accuracy") return run_cases(line->cases, "accuracy", "A");
  if (line->command == "stability") return run_cases(line->cases, "stability", "BC");
  if (line->command == "compare") return compare(line->compare, line->run);
  if (line->command == "wild") return wild(line->wild);
  return exit_ok;
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
