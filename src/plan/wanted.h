#pragma once
#include <cstdint>

namespace pcphys {

/// The island of a body is to be of this octave at least; `any_size`: also if it is a large one.
struct Wanted {
  std::uint32_t body;  // row
  std::uint8_t octave;
  bool any_size;
};

}  // namespace pcphys
