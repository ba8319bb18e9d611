// What the callbacks of forces answer in a step.
#pragma once
#include <vector>

#include "pcphys/result.h"
#include "pcphys/types.h"
#include "step/runner.h"
#include "world/state.h"

namespace pcphys {

class CalledForces {
 public:
  /// Asks all callbacks before any answer is written: they see one world, and a bad answer changes nothing.
  Status ask(const World& world);
  /// On top of the constant forces; `runner` keeps those for a step that fails.
  void add(WorldState& state, Runner& runner) const;

 private:
  std::vector<Wrench> answers_;
};

}  // namespace pcphys
