// One scene in pcphys and in peers, in turns of a few steps, so that what else happens on a machine hits all of them.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "peers/peer.h"
#include "simulation.h"

namespace pcphys::command {

/// Who takes part.
struct Entrant {
  std::string name, version, solver, precision;
  std::unique_ptr<peers::Peer> engine;  // pcphys too is one; none when it could not be made
  std::string problem;                  // why it is not there, or ended before the others
};

/// What is known of one of them after a contest.
struct Score {
  std::vector<double> ms;  // of each step after the warm-up
  std::uint64_t steps = 0;
  scenes::Metrics start, end;
  double peak_penetration = 0, peak_separation = 0, peak_energy = 0;
  scenes::LimitExcess peak_limit;
};

class Contest {
 public:
  /// Errors: those of the scene and of the settings. A peer that cannot be made takes part with its problem.
  static Result<Contest> make(const Setup& setup, std::span<const std::string> peers, const peers::Options& options);

  /// Each peer stops after `budget` seconds of stepping; `progress` is called after each turn with the steps made.
  /// Errors: those of pcphys's own steps.
  Status run(double budget, const std::function<void(std::uint64_t)>& progress);

  const World& world() const { return world_; }  // as it was built
  const scenes::Scene& scene() const { return scene_; }
  const std::vector<Entrant>& entrants() const { return entrants_; }  // pcphys first
  const Score& score(std::size_t entrant) const { return scores_[entrant]; }
  double dt() const { return setup_.dt; }
  /// Times are those of the processor where all runs on one thread of it, and of the wall clock where a GPU or more
  /// threads take part.
  bool processor_time() const;

 private:
  Contest(const Setup& setup, World world, scenes::Scene scene)
      : setup_(setup), world_(std::move(world)), scene_(std::move(scene)) {}
  Status turn(std::size_t entrant, std::uint64_t count, double budget);
  void look(std::size_t entrant, bool turn_ends);

  Setup setup_;
  World world_;
  scenes::Scene scene_;
  std::vector<Entrant> entrants_;
  std::vector<Score> scores_;
  std::vector<scenes::RimWatch> rims_;
  std::vector<double> seconds_;
};

}  // namespace pcphys::command
