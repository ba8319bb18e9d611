// Steps of fourth order as a sequence of stages (docs/integrate.md).
#pragma once
#include <array>
#include <bit>
#include <cstdint>

#include "pcphys/plan.h"

namespace pcphys {

/// Lengths of the stages of a sub-step, as shares of it: symmetric, and of fourth order where each stage is symmetric and of second.
/// M. Suzuki, Physics Letters A 146 (1990), 319: p, p, 1 - 4 p, p, p with p = 1 / (4 - 4^(1/3)).
inline constexpr std::array<double, 5> stage_shares{0.41449077179437573714, 0.41449077179437573714, -0.65796308717750294857,
                                                    0.41449077179437573714, 0.41449077179437573714};
inline constexpr std::uint32_t fourth_stages = stage_shares.size();

/// Sub-step classes: an octave of islands of second order, or of fourth.
inline constexpr unsigned class_count = 2 * octave_count;
inline constexpr bool is_fourth_order(unsigned island_class) { return island_class >= octave_count; }
inline constexpr unsigned octave_of(unsigned island_class) { return island_class % octave_count; }

/// Of classes as bits.
inline unsigned highest_octave(std::uint32_t classes) {
  return unsigned(std::bit_width((classes & ((1u << octave_count) - 1)) | classes >> octave_count)) - 1;
}

/// Blocks of numbers that kernels are given: those of a class stand together, by phase; after them, of fourth order, those of its stages.
inline constexpr std::uint32_t first_block(unsigned island_class) {
  return is_fourth_order(island_class) ? octave_count * phase_count + octave_of(island_class) * (phase_count + fourth_stages)
                                       : island_class * phase_count;
}
inline std::uint32_t block_of(const PlanEntry& entry) {
  const std::uint32_t stage = entry.phase == Phase::stage ? entry.substep % fourth_stages : 0;
  return first_block(entry.octave) + std::uint32_t(entry.phase) + stage;
}

}  // namespace pcphys
