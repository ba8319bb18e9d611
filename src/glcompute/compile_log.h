// What a GLSL compiler says, with the lines that it says it of.
#pragma once
#include <string>
#include <string_view>

#include "glcompute/program_source.h"

namespace pcphys {

/// A text of one line with each statement in a line of its own. The texts of PCPHYS_KERNEL are one line: the preprocessor joins them.
std::string by_statement(std::string_view line);

/// The log, and behind each of its lines that names a place the text that stands there. Mesa writes file:line(column), NVIDIA
/// file(line), of the numbers that #line gave.
std::string with_quotes(std::string_view log, const ProgramSource& source);

}  // namespace pcphys
