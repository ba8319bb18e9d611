// Times and memory of one design in one scene, and of transfers to the GPU.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>

#include "scenes.h"

namespace pcphys::architectures {

using Json = nlohmann::ordered_json;

struct Case {
  const NamedDesign* design;
  SceneKind scene;
  History history;
  std::size_t bodies;
};

/// Builds and steps in a process of its own, so that no heap holds what others left. None where the processor has no
/// such lanes. Keys: seconds a step of each stage, of a gather and a scatter, and of laying out lists after objects
/// have changed (medians); of building; bytes in use on the heap.
/// From 10,000 bodies on seconds are those of the thread.
std::optional<Json> measure(const Case& of);
/// Steps alone, for a profiler.
void only_step(const Case& of, std::size_t steps);

/// Uploads of so many bodies' position, velocity and mass, packed (32 bytes a body) and as the property world's tables
/// have them (96), through OpenGL, and the way back; in a process of its own. Key `problem` where there is no OpenGL.
Json measure_transfers(std::size_t bodies);

}  // namespace pcphys::architectures
