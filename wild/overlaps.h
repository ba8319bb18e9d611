// What the host makes overlap may be pushed out, and lifted: how much energy that may give. Of the library and of other
// engines alike.
#pragma once
#include <vector>

#include "pcphys/step.h"
#include "wild/observation.h"

namespace pcphys::wild {

class Overlaps {
 public:
  /// A body that overlaps others by the host's doing. With `others` what it was put into counts too.
  void made(const Eye& eye, int body, bool others);
  /// The same of all bodies.
  void made(const Eye& eye);
  /// Before the next step, of dt [s]: weights times depths, and what pushes give that undo them, at most at
  /// StepSettings::push_speed and no sooner than within a sub-step: an overlap of rounding gives no speed [J].
  double undone(const Eye& eye, const StepSettings& settings, double dt);

 private:
  struct Overlap {
    double mass, depth;
  };
  std::vector<Overlap> made_;  // since the last step
};

}  // namespace pcphys::wild
