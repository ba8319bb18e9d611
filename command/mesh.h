// Triangle meshes of the library's shapes, in the shape's own frame.
#pragma once
#include <cstdint>
#include <vector>

#include "pcphys/types.h"

namespace pcphys::command {

struct Mesh {
  std::vector<float> positions, normals;  // three numbers a vertex
  std::vector<std::uint16_t> indices;     // three a triangle, counter-clockwise seen from outside
};

Mesh make_mesh(const ShapeDef& shape);

}  // namespace pcphys::command
