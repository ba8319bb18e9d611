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
  if (grouped_ || !some(Form::joined)) return;
  if (!joined_) find_joined(s);
  group_joined(of_bodies);
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

void OwnLists::find_joined(const WorldState& s) {
  joined_ = true;
  by_id_.clear();
  for (std::uint32_t row = 1; row < s.joints.size(); row++) {
    const std::uint32_t a = s.body_ids.row(s.joints[row].body_a), b = s.body_ids.row(s.joints[row].body_b);
    if (s.goes(a) || s.goes(b)) by_id_.push_back({row, a, b, s.goes(a) ? a : b});
  }
  std::ranges::sort(by_id_, {}, [&](const Joined& j) { return s.joints[j.row].index; });
  const std::size_t rows = s.bodies.size();
  body_joints.assign(rows + 1 + 2 * by_id_.size(), 0);
  for (const Joined& j : by_id_)
    for (const std::uint32_t body : {j.a, j.b}) body_joints[body + 1]++;
  body_joints[0] = std::uint32_t(rows) + 1;
  for (std::size_t row = 0; row < rows; row++) body_joints[row + 1] += body_joints[row];
  std::vector<std::uint32_t> next(body_joints.begin(), body_joints.begin() + std::ptrdiff_t(rows));
  for (const Joined& j : by_id_) {
    body_joints[next[j.a]++] = 2 * j.row;
    body_joints[next[j.b]++] = 2 * j.row + 1;
  }
}

/// Both bodies that go are of one island, and so of one octave.
void OwnLists::group_joined(OctaveOf of_bodies) {
  grouped_ = true;
  version++;
  joined.clear();
  joined_ranges_.clear();
  for (unsigned octave = 0; octave < of_bodies.count; octave++) {
    const auto begin = std::uint32_t(joined.size() / 3);
    for (const Joined& j : by_id_)
      if (of_bodies.is(j.goes, octave)) joined.insert(joined.end(), {j.row, j.a, j.b});
    joined_ranges_.push_back({begin, std::uint32_t(joined.size() / 3)});
  }
  if (joined.empty()) joined.push_back(0);  // a device wants something to bind
}

}  // namespace pcphys
