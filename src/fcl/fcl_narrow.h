// FCL as the narrow phase (`--narrow fcl`) and as the oracle of the tests. Built without FCL, every function
// says so by its return value.
#pragma once
#include "collision/narrow.h"

namespace pcphys {

/// Whether this build has FCL.
bool fcl_available();

/// As `narrow`, by FCL: its contact points, or the closest points where the shapes are apart, reduced to four.
/// False when FCL is missing or gave up on this pair; `out` then holds no points. Features are numbers of points only.
bool narrow_fcl(const ShapeView<double>& a, const ShapeView<double>& b, double margin, Manifold<double>& out);
bool narrow_fcl(const ShapeView<float>& a, const ShapeView<float>& b, float margin, Manifold<float>& out);

/// Distance of two shapes [m], or minus the length of a way out of each other, which may not be the shortest. False as
/// above, and for planes.
bool distance_fcl(const ShapeView<double>& a, const ShapeView<double>& b, double& distance);

}  // namespace pcphys
