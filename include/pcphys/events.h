// What happened in a step, for those who ask (StepSettings): who touched, who let go, who hit whom, who moved,
// slept or woke. docs/events.md
#pragma once
#include <cstdint>
#include <span>

#include "pcphys/ids.h"
#include "pcphys/math.h"

namespace pcphys {

/// Two shapes: which of World::shapes(a) and World::shapes(b).
struct TouchingPair {
  BodyId a, b;
  std::uint32_t shape_a = 0, shape_b = 0;
  friend bool operator==(const TouchingPair&, const TouchingPair&) = default;
};

/// They touch since this step: a point was pressed, or they overlap.
struct ContactBegun : TouchingPair {
  Vec3 normal;  // from a to b
  Vec3 point;   // where they met, the mean of the points by their impulses; world axes [m]
  friend bool operator==(const ContactBegun&, const ContactBegun&) = default;
};

/// They touch no more: the gap is wider than the contact margin. Of bodies that were destroyed the ids are stale.
using ContactEnded = TouchingPair;

/// They met faster than StepSettings::hit_speed, whether they had touched before or not.
struct ContactHit : ContactBegun {
  double speed = 0;    // at which the gap closed along the normal [m/s]
  double impulse = 0;  // along the normal [N s]
  friend bool operator==(const ContactHit&, const ContactHit&) = default;
};

/// Of one step, until the next. Contacts stand in ascending order of their shapes, bodies of their ids; the order and
/// all numbers are the same on every backend, and for any number of lanes and threads.
struct StepEvents {
  std::span<const ContactBegun> begun;
  std::span<const ContactEnded> ended;
  std::span<const ContactHit> hits;
  std::span<const BodyId> moved;  // their position or orientation is another than before the step
  std::span<const BodyId> slept;  // they sleep since this step
  std::span<const BodyId> woken;  // they no longer do
};

}  // namespace pcphys
