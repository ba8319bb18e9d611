// Plays seeds of families one after another, on the library and in other engines, and sums up what was found.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "wild/verdict.h"

namespace pcphys::wild {

struct RunOptions {
  std::vector<std::string> families;  // none: all
  std::uint64_t first_seed = 1;
  std::uint64_t count = 0;  // scenes of each family; 0: as many as there is time for
  /// Of all families, shared equally; a scene is never cut short, so one that takes long adds to it [s]. 0: no end but
  /// `count`.
  double budget = 0;
  std::vector<Precision> precisions{Precision::f32};
  PlayOptions play;                // in each of these precisions
  std::vector<std::string> peers;  // of peers::variants, in the precision that each has
  /// Seeds that these divide are replayed in other ways that must give the same bits, and on OpenGL too; 0: none.
  std::uint64_t bits_every = 16, gl_every = 0;
};

/// One scene that broke, by the measure that is furthest beyond its bound.
struct Broken {
  std::uint64_t seed = 0, step = 0;
  Measure measure = Measure::count;  // count: a step could not be made
  double value = 0, bound = 0;
  std::string failure;
};

/// One measure over all scenes of a family in which it was measured.
struct Spread {
  std::uint64_t runs = 0, broken = 0;
  double median = 0, p99 = 0, p999 = 0, worst = 0;
  std::uint64_t seed = 0, step = 0;  // of the worst
  /// Least and largest over the scenes, since some follow sizes; none where it is not judged.
  std::optional<double> least_bound, largest_bound;
};

/// One family in one engine and precision.
struct Summary {
  static constexpr std::size_t most_listed = 20;

  std::string engine, family;  // "pcphys", or a peer's name
  std::string precision;       // "float" or "double"
  std::uint64_t runs = 0, broken = 0;
  std::uint64_t failed = 0;   // of the broken ones: a step could not be made
  std::uint64_t refused = 0;  // not among the runs: what a peer cannot hold
  std::string why_refused;    // the first of these
  std::array<Spread, measure_count> of{};
  /// How many broken scenes break it most.
  std::array<std::uint64_t, measure_count> most_broken{};
  /// Of all scenes the one that is furthest beyond its bound, or nearest to it where none is beyond.
  std::optional<Broken> worst;
  std::vector<Broken> listed;  // the first that broke
  std::uint64_t steps = 0;
  double body_steps = 0, seconds = 0;

  const Spread& operator[](Measure m) const { return of[std::size_t(m)]; }
  double ns_per_body_step() const { return body_steps > 0 ? 1e9 * seconds / body_steps : 0; }
};

struct RunState {
  const std::string& family;
  std::uint64_t scenes;  // played so far, of all families
  double seconds;        // since the start
  std::uint64_t broken;  // so far, of the library's
};

/// Seeds from the first one on, which are the same in every run. `progress` is told after each scene; false ends the
/// run. Summaries stand in the order of families, of each the library's first. Errors: unknown_name of a family or
/// peer.
Result<std::vector<Summary>> run(const RunOptions& options, const std::function<bool(const RunState&)>& progress);

/// "float" or "double".
const char* name(Precision precision);

}  // namespace pcphys::wild
