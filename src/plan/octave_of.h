#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace pcphys {

/// Of each element of a list which octave it is of (plan/octaves.h), below `count`.
struct OctaveOf {
  std::span<const std::uint8_t> octaves;  // empty: all are of octave 0
  unsigned count = 1;
  bool is(std::size_t i, unsigned octave) const { return octaves.empty() || octaves[i] == octave; }
};

}  // namespace pcphys
