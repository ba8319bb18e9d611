// Ways to step a world that must change no bit: who steps it, whether from its own snapshot, and where each step runs.
#pragma once
#include <functional>

#include "support_world.h"

namespace worldtest {

/// A world that is made anew for each way.
struct Stepped {
  std::function<World()> make;
  std::function<void(Stepper&, World&)> give = {};  // what each of its steppers has: kernels of the host's own
  StepSettings settings = {};
};

/// Checks that each step leaves the bits that one stepper with one lane leaves: with a new stepper each fifth step,
/// with two in turns, with other lanes and threads in each step, and from its own snapshot before each third; the first
/// few steps also with stages that are on GL and on the CPU by turns.
void check_same_ways(const Stepped& stepped, int steps, int steps_on_gl);

}  // namespace worldtest
