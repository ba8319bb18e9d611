// Text of what stands between the two programs of a kernel of the host's own: sums in variables,
// and in a block of their own.
#pragma once
#include <functional>
#include <string>

#include "glcompute/own_text.h"

namespace pcphys {

/// Statements for each number of what is summed: `each` with argument, suffix, and the word where it stands.
using EachNumber = std::function<std::string(const OwnArgument&, const std::string&, const std::string&)>;
std::string for_sums(const OwnKernel& k, const EachNumber& each);

/// Variables whose names begin with `prefix`: declared; set to zero; two of them put together.
std::string declare_sums(const OwnKernel& k, const std::string& prefix);
std::string clear(const OwnKernel& k, const std::string& prefix);
std::string combine(const OwnKernel& k, const std::string& into, const std::string& with);
std::string combined(const OwnArgument& a, const std::string& x, const std::string& y);

/// The block, and numbers in it as bits; pc_stride says how many values there is room for. Words of neighbours stand
/// side by side.
std::string sums_block(const OwnKernel& k, std::size_t binding);
/// To and from value `index` of the block.
std::string put(const OwnKernel& k, const std::string& prefix, const std::string& index);
std::string get(const OwnKernel& k, const std::string& prefix, const std::string& index);
std::string value_at(const OwnKernel& k, const OwnArgument& a, const std::string& word, const std::string& index);
/// What was summed, into properties.
std::string apply(const OwnKernel& k, const OwnText& own);

}  // namespace pcphys
