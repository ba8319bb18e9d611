// What the detector knows of a contact from sub-step to sub-step of a step: how its manifold was found, and how far apart its shapes are.
#pragma once
#include <array>
#include <cstdint>

namespace pcphys {

/// The motion of a contact's bodies since the step began (buffer `delta`): b's displacement against a's, and how each turned.
struct Moved {
  std::array<double, 3> apart{}, turned_a{}, turned_b{};
};

struct Standing {
  std::uint32_t shapes[2] = {0, 0};  // in the order of the contact's bodies
  std::uint32_t hint = 0;            // of the narrow phase
  bool touches = false;              // its shapes did, when they were looked at last
  bool acts = false;                 // its rows do
  std::uint8_t together = 0;         // bit i: at point i the shapes are together, now or where they meet in the sub-step
  double gap = 0;                    // of shapes that were apart then, at least [m]
  Moved then;                        // when they were looked at
};

}  // namespace pcphys
