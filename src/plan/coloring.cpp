#include "plan/coloring.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "collision/radix_sort.h"

namespace pcphys {

namespace {
/// As assign, but with room to grow: a contact or a colour more than ever before then allocates nothing.
template <class T> void assign_with_room(std::vector<T>& values, std::size_t count, T value) {
  if (count > values.capacity()) values.reserve(count + count / 2 + 64);
  values.assign(count, value);
}
}  // namespace

void Colouring::build(std::uint32_t unit_count, std::span<const std::uint32_t> units,
                      std::span<const std::uint32_t> priorities, std::span<const std::uint16_t> kinds) {
  assert(units.size() == 2 * priorities.size() && (kinds.empty() || kinds.size() == priorities.size()));
  sort_by_priority(priorities);
  colour_of_.resize(order_.size());
  const bool some_lead = std::ranges::any_of(kinds, [](std::uint16_t kind) { return kind >= first_leading; });
  std::uint32_t above = leading_colours_ = 0;
  for (const bool leads : {true, false}) {
    if (leads && !some_lead) continue;
    for (const bool with_fixed : {false, true}) above = choose(unit_count, units, kinds, with_fixed, leads, above);
    if (leads) leading_colours_ = above;
  }
  group(kinds);
}

void Colouring::sort_by_priority(std::span<const std::uint32_t> priorities) {
  const std::size_t count = priorities.size();
  order_.resize(count);
  order_scratch_.resize(count);
  for (std::size_t i = 0; i < count; ++i) order_[i] = std::uint64_t{priorities[i]} << 32 | i;
  const auto key = [](std::uint64_t item) { return item; };
  if (radix_sort(order_.data(), order_scratch_.data(), count, 32, 64, key) != order_.data())
    order_.swap(order_scratch_);
}

// Row `unit_count` stands for all fixed units: its mask is cleared whenever it was set.
std::uint32_t Colouring::choose(std::uint32_t unit_count, std::span<const std::uint32_t> units,
                                std::span<const std::uint16_t> kinds, bool with_fixed, bool leads,
                                std::uint32_t first) {
  taken_.assign(std::size_t{unit_count} + 1, 0);
  next_above_.clear();
  std::uint32_t above = first;
  std::uint64_t* taken = taken_.data();
  for (const std::uint64_t item : order_) {
    const auto i = static_cast<std::uint32_t>(item);
    const std::uint32_t a = std::min(units[2 * std::size_t{i}], unit_count),
                        b = std::min(units[2 * std::size_t{i} + 1], unit_count);
    if ((a == unit_count || b == unit_count) != with_fixed || (!kinds.empty() && (kinds[i] >= first_leading) != leads))
      continue;
    const std::uint64_t free = ~(taken[a] | taken[b]), lowest = free & (0 - free);
    taken[a] |= lowest;
    taken[b] |= lowest;
    taken[unit_count] = 0;
    colour_of_[i] =
        first + (free ? static_cast<std::uint32_t>(std::countr_zero(free)) : choose_above(a, b, unit_count));
    above = std::max(above, colour_of_[i] + 1);
  }
  return above;
}

std::uint32_t Colouring::choose_above(std::uint32_t a, std::uint32_t b, std::uint32_t unit_count) {
  if (next_above_.empty()) next_above_.assign(std::size_t{unit_count} + 1, mask_colours);
  const std::uint32_t colour = std::max(next_above_[a], next_above_[b]);
  next_above_[a] = next_above_[b] = colour + 1;
  next_above_[unit_count] = mask_colours;
  return colour;
}

void Colouring::group(std::span<const std::uint16_t> kinds) {
  std::uint32_t colours = 0;
  for (const std::uint32_t colour : colour_of_) colours = std::max(colours, colour + 1);
  assign_with_room(offsets_, std::size_t{colours} + 1, 0u);
  for (const std::uint32_t colour : colour_of_) ++offsets_[colour + 1];
  for (std::uint32_t c = 0; c < colours; ++c) offsets_[c + 1] += offsets_[c];
  assign_with_room(cursor_, offsets_.size(), 0u);
  std::ranges::copy(offsets_, cursor_.begin());
  list_.resize(colour_of_.size());
  const auto place = [&](std::uint32_t i) { list_[cursor_[colour_of_[i]]++] = i; };
  if (kinds.empty()) {
    for (std::uint32_t i = 0; i < colour_of_.size(); ++i) place(i);
    return;
  }
  std::uint32_t starts[most_kinds + 1] = {};  // of each kind in by_kind_: a counting sort
  for (const std::uint16_t kind : kinds) ++starts[kind + 1];
  for (std::uint32_t k = 0; k < most_kinds; ++k) starts[k + 1] += starts[k];
  by_kind_.resize(kinds.size());
  for (std::uint32_t i = 0; i < kinds.size(); ++i) by_kind_[starts[kinds[i]]++] = i;
  for (const std::uint32_t i : by_kind_) place(i);
}

void pack_slots(const Colouring& colouring, std::uint32_t width, std::span<const std::uint32_t> ends,
                std::span<const std::uint32_t> rows, Slots& out, OctaveOf of) {
  assert(width > 0 && ends.size() == 2 * rows.size() && rows.size() == colouring.constraints());
  assert(of.octaves.empty() || of.octaves.size() == rows.size());
  const std::uint32_t colours = colouring.colours(), leading = colouring.leading_colours();
  assign_with_room(out.ranges, std::size_t{of.count} * colours, Range{});
  const auto each_range = [&](auto visit) {
    for (const auto [first, end] : {Range{0, leading}, Range{leading, colours}})
      for (unsigned octave = 0; octave < of.count; octave++)
        for (std::uint32_t c = first; c < end; ++c) visit(octave, c, out.ranges[std::size_t{octave} * colours + c]);
  };
  std::uint32_t blocks = 0;
  each_range([&](unsigned octave, std::uint32_t c, Range& range) {
    const std::span<const std::uint32_t> all = colouring.of_colour(c);
    const auto count = of.octaves.empty()
                           ? all.size()
                           : std::size_t(std::ranges::count_if(all, [&](auto i) { return of.is(i, octave); }));
    const std::uint32_t first = blocks;
    blocks += (static_cast<std::uint32_t>(count) + width - 1) / width;
    range = {first, blocks};
  });
  assign_with_room(out.order, std::size_t{blocks} * width, 0u);
  assign_with_room(out.ends, std::size_t{blocks} * width * 2, 0u);
  each_range([&](unsigned octave, std::uint32_t c, const Range& range) {
    std::size_t slot = std::size_t{range.begin} * width, lane = 0;
    for (const std::uint32_t i : colouring.of_colour(c)) {
      if (!of.is(i, octave)) continue;
      const std::size_t side_a = 2 * (slot - lane) + lane;  // blocks hold `width` ends of side 0, then of side 1
      out.order[slot] = rows[i];
      out.ends[side_a] = ends[2 * std::size_t{i}];
      out.ends[side_a + width] = ends[2 * std::size_t{i} + 1];
      ++slot;
      if (++lane == width) lane = 0;
    }
  });
}

}  // namespace pcphys
