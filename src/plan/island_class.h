// Sub-step classes: islands of octave k make 2^k times the sub-steps that the settings ask for; of fourth order they
// are the class octave_count + k (docs/substeps.md, docs/integrate.md).
#pragma once
#include <bit>
#include <cstdint>

#include "pcphys/plan.h"

namespace pcphys {

inline constexpr unsigned class_count = 2 * octave_count;
inline constexpr bool is_fourth_order(unsigned island_class) { return island_class >= octave_count; }
inline constexpr unsigned octave_of(unsigned island_class) { return island_class % octave_count; }

/// Bit k: some of these classes, as bits, is of octave k.
inline constexpr std::uint32_t octaves_of(std::uint32_t classes) {
  return (classes & ((1u << octave_count) - 1)) | classes >> octave_count;
}

}  // namespace pcphys
