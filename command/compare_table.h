// What a contest found, for people and for files.
#pragma once
#include <string>

#include "contest.h"
#include "output.h"

namespace pcphys::command {

/// One object an entrant: the keys of docs/command.md.
Json compare_rows(const Contest& contest);
/// The same rows as text with commas, and its first line.
std::string compare_csv(const Json& rows, bool with_head);
/// A table of the scene.
std::string compare_text(const Contest& contest);

}  // namespace pcphys::command
