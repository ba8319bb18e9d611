// Views of properties: the world's own memory, strided, never copied.
#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pcphys/types.h"

namespace pcphys {

/// `count` rows of `components` reals each; row i starts `stride` bytes after row i - 1.
struct PropertyView {
  const std::byte* data = nullptr;
  std::size_t count = 0, stride = 0;
  std::uint32_t components = 0;
  Precision precision = Precision::f32;

  /// Component c of row i as a double, whatever the precision.
  double at(std::size_t i, std::uint32_t c = 0) const {
    assert(i < count && c < components);
    const std::byte* row = data + i * stride;
    return precision == Precision::f32 ? double(reinterpret_cast<const float*>(row)[c]) : reinterpret_cast<const double*>(row)[c];
  }
};

}  // namespace pcphys
