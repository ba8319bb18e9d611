// FCL as a narrow phase (StepSettings::narrow = NarrowPhase::fcl). It stands in a library of its own, so that
// hosts that do not ask for it do not link it: find_package(pcphys COMPONENTS fcl), target pcphys::fcl.
#pragma once
#include "pcphys/result.h"

namespace pcphys {

/// Offers FCL to every stepper of the process. Error: unavailable, when pcphys was built without FCL.
Status use_fcl();

}  // namespace pcphys
