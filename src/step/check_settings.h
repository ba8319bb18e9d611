// Checks of what a step is asked for. Each error says what was wrong and what to do.
#pragma once
#include "pcphys/step.h"

namespace pcphys {

Status check_settings(const StepSettings& settings);
Status check_dt(double dt);

}  // namespace pcphys
