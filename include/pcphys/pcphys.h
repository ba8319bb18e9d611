// Everything a host needs.
#pragma once
#include "pcphys/device.h"
#include "pcphys/events.h"
#include "pcphys/hull.h"
#include "pcphys/plan.h"
#include "pcphys/result.h"
#include "pcphys/step.h"
#include "pcphys/types.h"
#include "pcphys/version.h"
#include "pcphys/world.h"
