// The sub-commands. Each prints its result, and returns the exit code of the program.
#pragma once
#include "options.h"

namespace pcphys::command {

int run(const RunOptions& options);
int plan(const RunOptions& options);
int tables(const RunOptions& options);
int scenes_list(const OutputOptions& options);
int doctor(const OutputOptions& options);
/// The cases of these groups: "A" is accuracy, "BC" stability. `command` is shown with the progress.
int run_cases(const CaseOptions& options, const char* command, const std::string& groups);
/// Scenes in pcphys and in the peers that were found, in turns.
int compare(const CompareOptions& options, const RunOptions& run_options);

/// Random scenes, judged by what holds in all of them.
int wild(const WildOptions& options);

}  // namespace pcphys::command
