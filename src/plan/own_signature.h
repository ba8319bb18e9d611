// What a kernel of the host's own declares: the text of its signature, read.
#pragma once
#include <string>
#include <string_view>

#include "plan/own_kernels.h"

namespace pcphys {

/// Fills `arguments`, as far as the text alone says. Error: bad_argument.
Status parse_signature(OwnKernel& kernel);
/// GLSL would let a body write any buffer of its program by its name, past the signature. Error: bad_argument.
Status check_body(const OwnKernel& kernel);

/// PC_IN and so on.
std::string_view word_of(OwnArgument::Kind kind);
/// Of an argument of a body that a joint joins, the property with nothing but _a or _b taken away: `heat_of_a` may be
/// heat or heat_of.
std::string whole_property_of(const OwnArgument& argument);

}  // namespace pcphys
