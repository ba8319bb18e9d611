// A sequence of random calls on hosts that must agree, and what is asked after each call.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "calls.h"

namespace fuzz {

struct Counts {
  std::uint64_t sequences = 0, calls = 0, refused = 0, steps = 0;  // calls and steps on all hosts
  std::uint64_t digest = 0;                                        // of the worlds that came of them
};

struct Finding {
  std::string what;                // empty: nothing was found
  std::vector<std::string> calls;  // up to it
};

/// `gl`: some hosts step on a device.
Finding play(Choices& choices, bool gl, Counts& counts);

}  // namespace fuzz
