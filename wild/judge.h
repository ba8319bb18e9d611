// Judges a scene while it is played: the same for the library and for other engines.
#pragma once
#include <vector>

#include "wild/balance.h"
#include "wild/closings.h"
#include "wild/verdict.h"

namespace pcphys::wild {

/// What an engine tells of a step besides where bodies are.
struct StepFacts {
  double dt = 0;
  double contact_work = 0, contact_impulses = 0;  // Phantoms
  std::optional<double> phantom;  // widest gap over which a contact pushed, as a multiple of what is allowed
  std::optional<double> work;     // counted
  std::size_t frozen = 0;         // bodies that the engine gave up in this step
};

class Judge {
 public:
  Judge(const Scene& scene, Precision precision);

  /// Before the first step.
  void begin(const Observation& seen);
  /// A call between two steps has changed something.
  void changed(const Observation& before, const Observation& after);
  void stepped(const Observation& before, const Observation& after, const StepFacts& facts);
  /// The deepest overlap at the end, as a share of the smaller of the two shapes.
  void ended(const Observation& seen, double overlap);
  /// What undoing that the host made shapes overlap, or a joint stand open, may add [J].
  void allow(double energy) { balance_.allow(energy); }
  /// The host has left a joint open by `gap` [m]: as it closes it may stretch springs.
  void opened(int joint, double gap) { closings_.opened(std::size_t(joint), gap); }

  Verdict& verdict() { return verdict_; }

 private:
  void raise(Measure measure, double value, std::optional<double> bound);
  void judge_momentum(const Observation& seen, double dt);
  void judge_untouched(const Observation& seen);
  void judge_glide(const Observation& seen);
  void judge_bodies(const Observation& seen);
  double energy_bound() const;

  const Scene& scene_;
  bool f64_;
  double rounding_;  // of a number about 1
  Verdict verdict_;
  Balance balance_;
  Closings closings_;
  Observation start_;    // before the first step, or since the host last changed something
  double since_ = 0;     // then [s]
  bool closed_ = false;  // nothing acts from outside: momentum is conserved
  double most_momentum_ = 0, most_angular_momentum_ = 0;
  std::vector<double> works_;
};

}  // namespace pcphys::wild
