// The pull of magnets on each other: examples/magnets.cpp, and a benchmark.
#pragma once
#include "pcphys/write_kernel.h"

PCPHYS_PAIR_KERNEL(magnet,
                   (PC_SELF(Vec3) position, PC_SELF(Real) pole, PC_OTHER(Vec3) position_other,
                    PC_OTHER(Real) pole_other, PC_ADD(Vec3) force, PC_PARAM(Real) strength, PC_PARAM(Real) softening),
                   {
                     Vec3 away = pc_sub(position_other, position);
                     precise Real r2 = pc_dot(away, away) + softening;
                     precise Real r3 = r2 * pc_sqrt(r2);
                     precise Real poles = pole * pole_other;
                     precise Real pull = poles * strength;
                     force = pc_scale(away, pc_div(pull, r3));  // of this pair; the library sums
                   })
