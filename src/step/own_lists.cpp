#include "step/own_lists.h"

#include <algorithm>

namespace pcphys {
namespace {

template <class Record> void sort_by_id(std::span<std::uint32_t> rows, const std::vector<Record>& records) {
  std::ranges::sort(rows, {}, [&](std::uint32_t row) { return records[row].index; });
}

}  // namespace

void OwnLists::order(const WorldState& s, const OwnKernels& kernels, OctaveOf of_bodies) {
  using Form = OwnKernel::Form;
  const auto some = [&](auto... forms) {
    return std::ranges::any_of(kernels.ordered(), [&](const auto& k) { return ((k->form == forms) || ...); });
  };
  if (!ordered_ && some(Form::pair, Form::reduction)) order_rows(s);
  if (!joined_ && some(Form::joined)) find_joined(s, of_bodies);
}

void OwnLists::order_rows(const WorldState& s) {
  ordered_ = true;
  version++;
  const std::uint32_t count = std::uint32_t(s.bodies.size());  // row 0, the ground, among them
  bodies.assign(2 * std::size_t{count} - 1, 0);
  const std::span ordered = std::span(bodies).subspan(count);
  for (std::uint32_t row = 1; row < count; row++) ordered[row - 1] = row;
  sort_by_id(ordered, s.bodies);
  for (std::uint32_t place = 0; place + 1 < count; place++) bodies[ordered[place]] = place;
  moving.clear();
  for (const std::uint32_t row : ordered)
    if (!s.stands(row)) moving.push_back(row);
  movable = std::uint32_t(moving.size());
  joints.clear();
  for (std::uint32_t row = 1; row < s.joints.size(); row++) joints.push_back(row);
  sort_by_id(std::span(joints), s.joints);
  for (std::vector<std::uint32_t>* list : {&moving, &joints})
    if (list->empty()) list->push_back(0);  // a device wants something to bind
}

void OwnLists::find_joined(const WorldState& s, OctaveOf of_bodies) {
  joined_ = true;
  version++;
  struct Joint {
    std::uint32_t row, a, b, octave;
  };
  std::vector<Joint> found;
  for (std::uint32_t row = 1; row < s.joints.size(); row++) {
    const std::uint32_t a = s.body_ids.row(s.joints[row].body_a), b = s.body_ids.row(s.joints[row].body_b);
    if (!s.goes(a) && !s.goes(b)) continue;
    // both that go are of one island, and so of one octave
    found.push_back({row, a, b, of_bodies.octaves.empty() ? 0u : of_bodies.octaves[s.goes(a) ? a : b]});
  }
  std::ranges::sort(found, {}, [&](const Joint& j) { return s.joints[j.row].index; });
  const std::size_t rows = s.bodies.size();
  body_joints.assign(rows + 1 + 2 * found.size(), 0);
  for (const Joint& j : found)
    for (const std::uint32_t body : {j.a, j.b}) body_joints[body + 1]++;
  body_joints[0] = std::uint32_t(rows) + 1;
  for (std::size_t row = 0; row < rows; row++) body_joints[row + 1] += body_joints[row];
  std::vector<std::uint32_t> next(body_joints.begin(), body_joints.begin() + std::ptrdiff_t(rows));
  for (const Joint& j : found) {
    body_joints[next[j.a]++] = 2 * j.row;
    body_joints[next[j.b]++] = 2 * j.row + 1;
  }
  joined.clear();
  joined_ranges_.clear();
  for (std::uint32_t octave = 0; octave < of_bodies.count; octave++) {
    const auto begin = std::uint32_t(joined.size() / 3);
    for (const Joint& j : found)
      if (j.octave == octave) joined.insert(joined.end(), {j.row, j.a, j.b});
    joined_ranges_.push_back({begin, std::uint32_t(joined.size() / 3)});
  }
  if (joined.empty()) joined.push_back(0);
}

}  // namespace pcphys
