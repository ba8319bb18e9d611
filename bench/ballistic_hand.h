// What one would write by hand for a world of balls in free fall: one loop over the tables' own arrays, that knows that
// nothing else is in them (one sub-step length, equal moments, no drag, turns of less than half a radian a sub-step).
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace ballistic {

/// Rows of the body table, as src/kernels/properties.inl lays them out, in float; and what acts on all.
struct Arrays {
  std::vector<float> motion, pose, velocity_parts, mass, force;
  std::size_t bodies = 0;  // from row 1 on
  float gravity[3] = {}, h = 0;
  int substeps = 0;
};

/// A step of them, on one thread; vectorised by the compiler, for AVX2.
void step(Arrays& arrays);
/// The same as a compute shader, a body an invocation.
const char* shader();

}  // namespace ballistic
