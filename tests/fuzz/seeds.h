// Where a fuzz target begins: inputs that the target makes itself, so that no corpus is kept. They are drawn from by
// LLVMFuzzerCustomMutator of seeds.cpp.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fuzz {

/// A target defines it.
std::vector<std::vector<std::uint8_t>> seeds();

/// A target defines it: how wide the numbers of an input are that begins with this byte: 8 or 4 [bytes], from the
/// second byte on in steps of 4; 0 where it has none. Some are then drawn of every size, which changes of bits hardly
/// ever make.
std::size_t number_bytes(std::uint8_t head);

}  // namespace fuzz
