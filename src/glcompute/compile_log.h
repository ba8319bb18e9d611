// What a GLSL compiler says, with the lines that it says it of.
#pragma once
#include <string>
#include <string_view>

#include "glcompute/program_source.h"

namespace pcphys {

/// A text of one line with each statement in a line of its own. The texts of PCPHYS_KERNEL are one line: the
/// preprocessor joins them, and only where something is to be said of them their own lines are
/// looked up (plan/kernel_lines.h).
std::string by_statement(std::string_view line);
/// What the name of a file ends in whose lines are such statements.
inline constexpr std::string_view counted_by_statement = " statement by statement";

/// The log, and behind each of its lines that names a place the text that stands there, with its file and line where it
/// has any. Mesa writes file:line(column), NVIDIA file(line), of the numbers that #line gave.
std::string with_quotes(std::string_view log, const ProgramSource& source);

}  // namespace pcphys
