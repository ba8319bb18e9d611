// The smallest scene that still breaks, and a scene as a program.
#pragma once
#include <functional>
#include <string>

#include "wild/verdict.h"

namespace pcphys::wild {

/// Takes out calls, and steps, as long as `measure` (or the failure of a step, where it is `count`) still breaks.
/// `progress` is told how many calls and steps are left; false stops, with the smallest so far.
Scene shrink(const Scene& scene, const PlayOptions& options, Measure measure,
             const std::function<bool(std::size_t calls, std::uint64_t steps)>& progress);

/// A C++ program of the public API alone that plays the scene and prints energy and the fastest body after each step.
/// Numbers are the shortest decimals that read back as what they were.
std::string as_program(const Scene& scene, const PlayOptions& options, const Verdict& verdict);

}  // namespace pcphys::wild
