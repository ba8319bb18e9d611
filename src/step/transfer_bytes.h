// What the transfers of a plan move, in bytes: of the plan and the sizes of a world alone, with no device at hand.
#pragma once
#include "plan/plan.h"
#include "step/schedule.h"
#include "world/state.h"

namespace pcphys {

/// Sets PlanEntry::bytes. `schedule`: of this world, its structure followed; here it is given the contacts of the
/// world's last step, and laid out as a device wants it.
void measure_transfers(StepPlan& plan, const WorldState& state, Schedule& schedule);

}  // namespace pcphys
