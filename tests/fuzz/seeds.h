// Where a fuzz target begins: inputs that the target makes itself, so that no corpus is kept. They are drawn from by
// LLVMFuzzerCustomMutator of seeds.cpp.
#pragma once
#include <cstdint>
#include <vector>

namespace fuzz {

/// A target defines it.
std::vector<std::vector<std::uint8_t>> seeds();

}  // namespace fuzz
