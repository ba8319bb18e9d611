// What a plan leaves out, and why.
#pragma once
#include "plan/own_kernels.h"
#include "plan/plan.h"

namespace pcphys {

void leave_out(const PlanSignature& signature, OwnKernels::Ordered own, StepPlan& plan);

}  // namespace pcphys
