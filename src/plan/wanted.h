#pragma once
#include <cstdint>

namespace pcphys {

/// The island of a body is to be of this octave at least.
struct Wanted {
  std::uint32_t body;  // row
  std::uint8_t octave;
  bool more = false;  // would ask for more than there are
};

/// The octave that brings what falls with the square of the sub-step to `aim`, or `highest`.
inline std::uint8_t octave_for(double value, double aim, std::uint8_t highest) {
  std::uint8_t octave = 0;
  for (; value > aim && octave < highest; value /= 4) octave++;
  return octave;
}

}  // namespace pcphys
