// What forces are before kernels of the host's own add to them.
#pragma once
#include "pcphys/kernel.h"
#include "world/state.h"

namespace pcphys {

/// Gives the world the columns in which constant forces and callbacks stand from now on (WorldState::gathered).
void gather_forces(WorldState& state);
/// And takes them back.
void stop_gathering(WorldState& state);
/// The kernel with which a step or sub-step begins them anew.
KernelDef gathering(bool once_a_step);

}  // namespace pcphys
