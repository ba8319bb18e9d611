#include "step/own_lists.h"

#include <algorithm>

namespace pcphys {
namespace {

template <class Record> void sort_by_id(std::span<std::uint32_t> rows, const std::vector<Record>& records) {
  std::ranges::sort(rows, {}, [&](std::uint32_t row) { return records[row].index; });
}

}  // namespace

void OwnLists::order(const WorldState& s, std::span<const std::uint32_t> rows_that_move, const OwnKernels& kernels) {
  const bool wanted = std::ranges::any_of(kernels.ordered(), [](const auto& k) { return k->form != OwnKernel::Form::element; });
  if (known_ || !wanted) return;
  known_ = true;
  version++;
  const std::uint32_t count = std::uint32_t(s.bodies.size());  // row 0, the ground, among them
  bodies.assign(2 * std::size_t{count} - 1, 0);
  const std::span ordered = std::span(bodies).subspan(count);
  for (std::uint32_t row = 1; row < count; row++) ordered[row - 1] = row;
  sort_by_id(ordered, s.bodies);
  for (std::uint32_t place = 0; place + 1 < count; place++) bodies[ordered[place]] = place;
  moving.assign(rows_that_move.begin(), rows_that_move.end());
  sort_by_id(std::span(moving), s.bodies);
  joints.clear();
  for (std::uint32_t row = 1; row < s.joints.size(); row++) joints.push_back(row);
  sort_by_id(std::span(joints), s.joints);
  for (std::vector<std::uint32_t>* list : {&moving, &joints})
    if (list->empty()) list->push_back(0);  // a device wants something to bind
}

}  // namespace pcphys
