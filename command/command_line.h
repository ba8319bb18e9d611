// What stands on the command line of the program, read and not yet run.
#pragma once
#include <string>

#include "options.h"

namespace pcphys::command {

struct CommandLine {
  std::string command;  // the sub-command's name; empty where help or the version was asked for
  std::string help;     // what is then printed
  RunOptions run;
  OutputOptions output;
  CaseOptions cases;
  CompareOptions compare;
  WildOptions wild;
};

/// Errors: bad_argument, with what is wrong with the line. Values are as they were typed: `resolve` checks them.
Result<CommandLine> read_command_line(int argc, const char* const* argv);

}  // namespace pcphys::command
