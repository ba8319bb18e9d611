// What a scene is judged by, and what was found.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "wild/play.h"
#include "wild/scene.h"

namespace pcphys::wild {

/// In the order in which tables show them.
enum class Measure : std::uint8_t {
  energy,            // made within steps, beyond what drives put in
  momentum,          // change of what is free
  angular_momentum,  // change of what is free
  free_speed,        // change of velocity of what touches nothing
  phantom,           // gap between shapes over which a contact pushed
  overlap,           // at rest
  joint_gap,         // of trees
  limit_excess,      // of trees
  glide,             // change of velocity along frictionless, level tiles
  hop,               // how high one sends what glides over it
  stand,             // how far a tower moved
  lost,              // bodies outside of where they belong
  frozen,            // bodies that the library gave up
  not_finite,        // bodies with numbers that are none
  work,              // counted work of the costliest step over the median's
  bits,              // replays with other bits
  count
};
inline constexpr std::size_t measure_count = std::size_t(Measure::count);

struct MeasureInfo {
  std::string_view name, unit, meaning;
};
const MeasureInfo& info(Measure measure);

struct Finding {
  bool measured = false;
  double worst = 0;
  /// Above it the scene is broken; absent where this is measured and not judged.
  std::optional<double> bound;
  std::uint64_t step = 0;  // after which it was worst, from 1

  bool broken() const { return bound && !(worst <= *bound); }
  /// As a multiple of its bound, where there is one; up to 1 it holds. Where nothing at all is allowed one is as bad as
  /// twice a bound.
  double excess() const;
};

struct Verdict {
  std::array<Finding, measure_count> of{};
  std::uint64_t steps = 0;
  double body_steps = 0;  // bodies that move, summed over steps
  double seconds = 0;     // in Stepper::step alone
  std::string failure;    // of a step that could not be made; then the scene is broken, whatever was measured

  const Finding& operator[](Measure m) const { return of[std::size_t(m)]; }
  Finding& operator[](Measure m) { return of[std::size_t(m)]; }
  bool broken() const;
  /// The measure that is furthest beyond its bound; `count` where none is.
  Measure worst() const;
};

/// Plays the scene on the library and judges it.
Verdict judge(const Scene& scene, const PlayOptions& options);

/// Plays it again in other ways that must give the same bits: in 1, 4 and 8 lanes, with two threads, with two steppers
/// in turns, with new ones every few steps, with unrelated islands, with snapshots restored, and, with `gl`, as OpenGL
/// compute and with stages there and on the CPU by turns; how many differ goes into Measure::bits of `verdict`.
void judge_bits(const Scene& scene, const PlayOptions& options, bool gl, Verdict& verdict);

/// The same scene and the same judge in another engine (peers::variants). Errors: unknown_name; unavailable where the
/// engine was not found, or cannot hold the scene.
Result<Verdict> judge_peer(const Scene& scene, std::string_view peer);

}  // namespace pcphys::wild
