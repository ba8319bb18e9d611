// Finds out how a device rounds: which form of division and square root equals the CPU's for every operand
// tried, whether fma fuses, whether `precise` keeps two roundings, whether subnormals survive.
#pragma once
#include "glcompute/program_cache.h"
#include "pcphys/device.h"
#include "pcphys/result.h"
#include "pcphys/types.h"

namespace pcphys {

/// In the current context; binds a program and two storage buffers. The answer is kept in the cache.
Result<GlArithmetic> probe_arithmetic(Precision precision, const ProgramCache& cache);

}  // namespace pcphys
