// Colours for constraints: no two of a colour share a unit that moves, so all of a colour can be solved side
// by side, in any order, with the same result.
//
// Sequential greedy in order of priority: each constraint gets the lowest colour that is free on both of its
// units. Constraints stand in groups, whose colours follow one another; within a group those with a fixed unit choose
// after all others, above their colours: a solver that visits colours in turn then leaves floor and walls with the last
// word, and less is pressed through them (docs/impulses.md).
// That result is unique, so any executor that computes it agrees (Jones-Plassmann on the GPU: in each
// round the constraints of highest priority on both units choose; M. Jones and P. Plassmann, A Parallel Graph
// Coloring Heuristic, 1993). Priorities are hashes of ids: what happens elsewhere renumbers nothing here.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "plan/octave_of.h"
#include "step/backend.h"
#include "world/memory.h"

namespace pcphys {

/// Bijective on 32 bits (C. Wellons, "lowbias32"); 32-bit operations alone, so that GLSL can run it.
constexpr std::uint32_t mixed(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

/// Priority of a constraint between two bodies, by their ids (not rows) and what kind of constraint it is.
/// For one lower id and kind no two higher ids collide.
constexpr std::uint32_t priority(std::uint32_t lower_id, std::uint32_t higher_id, std::uint32_t kind) {
  return mixed(mixed(mixed(kind + 0x9e3779b9u) ^ lower_id) ^ higher_id);
}

class Colouring {
 public:
  /// A unit that nothing moves: the ground, fixed and kinematic bodies. It conflicts with nothing.
  static constexpr std::uint32_t fixed_unit = 0xffffffffu;
  static constexpr std::uint32_t first_leading = 3, most_kinds = first_leading + 512;

  /// Constraint i acts on units[2i] and units[2i + 1], each below `unit_count` or `fixed_unit`. Lower
  /// priorities choose first; of equal ones the constraint with the lower index. `kinds`: from `first_leading` on where
  /// a constraint belongs to the first group of colours; those of a kind stand together within a colour, in ascending
  /// order. Empty where there is one group of one kind.
  /// The first 64 colours of either kind are greedy exactly. What finds none of them free goes on above: it takes the
  /// colour after the last one above 63 on either unit. Only a unit with more than 64 constraints comes to that.
  void build(std::uint32_t unit_count, std::span<const std::uint32_t> units, std::span<const std::uint32_t> priorities,
             std::span<const std::uint16_t> kinds = {});

  std::uint32_t colours() const { return static_cast<std::uint32_t>(offsets_.size()) - 1; }
  /// Of the first group.
  std::uint32_t leading_colours() const { return leading_colours_; }
  std::uint32_t constraints() const { return static_cast<std::uint32_t>(list_.size()); }
  /// The constraints of a colour in ascending order of kind and index (of the caller's table).
  std::span<const std::uint32_t> of_colour(std::uint32_t colour) const {
    return std::span(list_).subspan(offsets_[colour], offsets_[colour + 1] - offsets_[colour]);
  }
  std::span<const std::uint32_t> offsets() const { return offsets_; }  // colours() + 1 into list()
  std::span<const std::uint32_t> list() const { return list_; }
  std::span<const std::uint32_t> colour_of() const { return colour_of_; }
  std::size_t memory_bytes() const {
    return bytes_of(offsets_, list_, colour_of_, order_, order_scratch_, taken_, next_above_, cursor_, by_kind_);
  }

 private:
  static constexpr std::uint32_t mask_colours = 64;

  void sort_by_priority(std::span<const std::uint32_t> priorities);
  /// Colours the constraints of a group with a fixed unit, or those without, from `first` on;
  /// the first colour above them.
  std::uint32_t choose(std::uint32_t unit_count, std::span<const std::uint32_t> units,
                       std::span<const std::uint16_t> kinds, bool with_fixed, bool leads, std::uint32_t first);
  std::uint32_t choose_above(std::uint32_t a, std::uint32_t b, std::uint32_t unit_count);
  void group(std::span<const std::uint16_t> kinds);

  std::vector<std::uint32_t> offsets_{0}, list_, colour_of_;
  std::vector<std::uint64_t> order_, order_scratch_;  // priority << 32 | constraint
  std::vector<std::uint64_t> taken_;                  // per unit; bit c: colour c
  std::vector<std::uint32_t> next_above_;             // per unit, empty until some unit needs it
  std::vector<std::uint32_t> cursor_, by_kind_;
  std::uint32_t leading_colours_ = 0;
};

/// Slots of a backend with `width` lanes. Each colour fills whole blocks; the slots left over are padding,
/// which is row 0 everywhere: a constraint that does nothing between the ground and itself.
struct Slots {
  std::vector<std::uint32_t> ends;   // ends[(block * 2 + side) * width + lane]: body row
  std::vector<std::uint32_t> order;  // order[block * width + lane]: row of the constraint's table
  std::vector<Range> ranges;         // blocks of each colour, by octave

  std::uint32_t blocks() const { return ranges.empty() ? 0 : ranges.back().end; }
  std::size_t memory_bytes() const { return bytes_of(ends, order, ranges); }
};

/// `ends[2i]`, `ends[2i + 1]`: body rows of constraint i; `rows[i]`: its row. Constraints of the leading group of
/// colours come first, of all octaves; the range of a colour and octave is `ranges[octave * colours + colour]`.
void pack_slots(const Colouring& colouring, std::uint32_t width, std::span<const std::uint32_t> ends,
                std::span<const std::uint32_t> rows, Slots& out, OctaveOf of = {});

}  // namespace pcphys
