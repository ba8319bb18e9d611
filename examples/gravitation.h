// The pull of masses on each other, and what it is worth as energy: examples/gravity.cpp, and a plot.
#pragma once
#include "pcphys/write_kernel.h"

PCPHYS_PAIR_KERNEL(gravitation,
                   (PC_SELF(Vec3) position, PC_SELF(Real) mass, PC_OTHER(Vec3) position_other,
                    PC_OTHER(Real) mass_other, PC_ADD(Vec3) force, PC_SUM(Real) potential, PC_PARAM(Real) G,
                    PC_PARAM(Real) softening),
                   {
                     Vec3 away = pc_sub(position_other, position);
                     precise Real r2 = pc_dot(away, away) + softening;
                     Real r = pc_sqrt(r2);
                     precise Real masses = mass * mass_other;
                     Real well = pc_div(G * masses, r);
                     potential = -well;
                     force = pc_scale(away, pc_div(well, r2));
                   })
