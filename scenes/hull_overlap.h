// Overlap of two hulls, by definition and without the library's own collision code.
#pragma once
#include "pcphys/hull.h"
#include "pcphys/math.h"

namespace pcphys::scenes {

/// Depth along the axis of least overlap, over the normals of all faces and the products of all edges; 0 when some
/// axis separates them [m].
double overlap(const Hull& a, const Pose& pose_a, const Hull& b, const Pose& pose_b);

}  // namespace pcphys::scenes
