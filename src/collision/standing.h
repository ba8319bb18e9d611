// What the detector knows of a contact from sub-step to sub-step of a step.
#pragma once
#include <array>
#include <cstdint>

#include "pcphys/math.h"

namespace pcphys {

struct Standing {
  std::uint32_t shapes[2] = {0, 0};  // in the order of the contact's bodies
  std::uint32_t rows[2] = {0, 0};    // of its bodies
  double gap = 0;                    // of shapes that were apart when they were looked at last, at least [m]
  float thick = 0;                   // see Detector::thickness [m]
  float looked = 0;                  // how far its shapes had moved by then in this step, together, at most [m]
  std::uint32_t hint = 0;            // of the narrow phase
  std::uint32_t later = 0;           // its record of looks within the step, if any
  bool touches = false;              // its shapes did, when they were looked at last
  bool acts = false;                 // its rows do
  bool struck = false;               // as an impact: nothing of it lasts
  bool waits = false;                // for an impact that comes before
  // its shapes were apart when the step began, and come together in it by their own motion
  bool soon = false;
  bool bounces = false;  // what is fast enough does
  bool jointed = false;  // a body of it hangs on joints
  // bit i: at point i the shapes are together, now or where they meet in the sub-step
  std::uint8_t together = 0;
};

/// The motion of a contact's bodies since the step began (buffer `delta`): b's displacement against a's,
/// and how each turned.
struct Moved {
  std::array<double, 3> apart{}, turned_a{}, turned_b{};
};

/// Of a contact that was looked at within the step: how its bodies had moved by then, and where the first body's centre
/// was when the rows were found, as the contact's points see it [m].
struct Later {
  Moved moved;
  Vec3 origin;
};

/// Bounds of what a body's motion does to its shapes: how far it has brought any point of them since the step began,
/// and how far it may in this sub-step [m].
struct Way {
  float went = 0, goes = 0;
  std::uint32_t of = 0;  // the look that it is of (Detector::looks_)
};

}  // namespace pcphys
