// The balance of energy of a scene: what it has, what drives and the host put in, and how far it rose beyond that.
#pragma once
#include "wild/observation.h"

namespace pcphys::wild {

class Balance {
 public:
  /// `rests`: of scenes in which bodies may lie still, whose own scale is then nothing. What lifts each of them by its
  /// own size belongs to the scale there. `rounding`: of a number about 1; what moves no faster than roundings of its
  /// place are apart in a step does not move.
  explicit Balance(double rounding, bool rests = true) : rounding_(rounding), rests_(rests) {}
  void begin(const Observation& seen);
  /// The host has changed something between two steps: that is no rise, but counts as put in.
  void changed(const Observation& before, const Observation& after);
  /// After a step of `dt` [s] in which drives put in at most `work` [J].
  void stepped(const Observation& seen, double work, double dt);
  /// Undoing overlaps and gaps that the host made may add so much more [J].
  void allow(double energy) { allowed_ += energy; }

  /// The largest rise beyond the lowest so far and what drives put in, as a share of the scale: the most kinetic and
  /// spring energy before it, the largest change of potential energy, what drives and the host put in, what `rests`
  /// adds, and roundings.
  double rise() const { return rise_; }

 private:
  double rounding_;
  bool rests_;
  void see_fall(const Observation& seen);
  void see_scale(const Observation& seen);

  double start_potential_ = 0, offset_ = 0, put_in_ = 0, allowed_ = 0;
  double lowest_ = 0, rise_ = 0, motion_ = 0, fall_ = 0, lift_ = 0, noise_ = 0;
};

/// What motors, constant forces and, by the momentum that they exchange, kinematic bodies may have put in within a step
/// through joints and springs; at most [J].
double driven_work(const Observation& before, const Observation& after, double contact_impulses, double dt);

/// Exactly, of one kinematic body that meets one dynamic body by contacts alone.
double encounter_work(const Observation& before, const Observation& after, double dt);

}  // namespace pcphys::wild
