#include "plan/nets.h"

#include <algorithm>
#include <map>

#include "world/union_find.h"

namespace pcphys {
namespace {

constexpr std::uint32_t header = 4;  // numbers of a block

}  // namespace

void Nets::build(const WorldState& state) {
  nets_.clear();
  shapes_.clear();
  held_.assign(state.joints.size(), 0);
  springs_ = most_alike_ = 0;
  UnionFind groups(state.bodies.size());
  std::vector<char> pinned(state.bodies.size(), 0);
  std::vector<std::uint32_t> springs;
  for (std::uint32_t row = 1; row < state.joints.size(); row++) {
    const JointRecord& joint = state.joints[row];
    if (state.asleep(joint)) continue;
    const std::uint32_t a = state.body_ids.row(joint.body_a), b = state.body_ids.row(joint.body_b);
    if (!joint.spring)
      pinned[a] = pinned[b] = 1;
    else if (joint.driven() && (state.responds(a) || state.responds(b)))
      springs.push_back(row);
    if (joint.spring && joint.driven() && state.responds(a) && state.responds(b)) groups.join(a, b);
  }
  std::vector<char> held_by_pins(state.bodies.size(), 0);
  for (std::uint32_t row = 0; row < state.bodies.size(); row++)
    if (pinned[row] && state.responds(row)) held_by_pins[groups.root(row)] = 1;
  std::map<std::uint32_t, std::vector<std::uint32_t>> of_root;
  std::ranges::sort(springs, {}, [&](std::uint32_t row) { return state.joints[row].index; });
  for (const std::uint32_t row : springs) {
    const std::uint32_t a = state.body_ids.row(state.joints[row].body_a);
    const std::uint32_t b = state.body_ids.row(state.joints[row].body_b);
    const std::uint32_t root = groups.root(state.responds(a) ? a : b);
    if (!held_by_pins[root]) of_root[root].push_back(row);
  }
  for (const auto& [root, rows] : of_root) add(state, rows);
  std::map<std::vector<std::uint32_t>, std::size_t> known;
  for (std::uint32_t i = 0; i < nets_.size(); i++) {
    const auto [at, is_new] = known.try_emplace(nets_[i].links, shapes_.size());
    if (is_new) shapes_.emplace_back();
    shapes_[at->second].push_back(i);
  }
  for (const auto& alike : shapes_) most_alike_ = std::max(most_alike_, std::uint32_t(alike.size()));
}

void Nets::add(const WorldState& state, std::span<const std::uint32_t> springs) {
  Net net;
  net.springs.assign(springs.begin(), springs.end());
  const auto id = [&](std::uint32_t row) { return state.bodies[row].index; };
  for (const std::uint32_t row : springs)
    for (const std::uint32_t body : {state.joints[row].body_a, state.joints[row].body_b})
      net.bodies.push_back(state.body_ids.row(body));
  std::ranges::sort(net.bodies, {}, id);
  net.bodies.erase(std::unique(net.bodies.begin(), net.bodies.end()), net.bodies.end());
  for (const std::uint32_t row : springs) {
    for (const std::uint32_t body : {state.joints[row].body_a, state.joints[row].body_b}) {
      const auto at = std::ranges::lower_bound(net.bodies, id(state.body_ids.row(body)), {}, id);
      net.links.push_back(std::uint32_t(at - net.bodies.begin()));
    }
    held_[row] = 1;
  }
  net.moving = *std::ranges::find_if(net.bodies, [&](std::uint32_t row) { return state.responds(row); });
  springs_ += std::uint32_t(springs.size());
  nets_.push_back(std::move(net));
}

void Nets::pack(std::uint32_t width, OctaveOf of, NetBlocks& out) const {
  std::vector<std::vector<std::uint32_t>> blocks;
  out.ranges.assign(of.count, {0, 0});
  for (unsigned octave = 0; octave < of.count; octave++) {
    out.ranges[octave].begin = std::uint32_t(blocks.size());
    for (const auto& alike : shapes_) {
      std::vector<std::uint32_t> block;
      for (const std::uint32_t i : alike) {
        if (!of.is(i, octave)) continue;
        if (block.size() == width) blocks.push_back(std::move(block)), block.clear();
        block.push_back(i);
      }
      if (!block.empty()) blocks.push_back(std::move(block));
    }
    out.ranges[octave].end = std::uint32_t(blocks.size());
  }
  out.list.assign(blocks.size() * header, 0);
  out.slots = 0;
  for (std::size_t k = 0; k < blocks.size(); k++) {
    const Net& like = nets_[blocks[k].front()];
    const auto bodies = std::uint32_t(like.bodies.size()), springs = std::uint32_t(like.springs.size());
    const std::uint32_t numbers[header] = {out.slots, bodies, springs, std::uint32_t(out.list.size())};
    std::ranges::copy(numbers, out.list.begin() + std::ptrdiff_t(k * header));
    out.list.insert(out.list.end(), like.links.begin(), like.links.end());
    const std::size_t rows = out.list.size();
    out.list.resize(rows + std::size_t{width} * (bodies + springs), 0);
    for (std::size_t lane = 0; lane < blocks[k].size(); lane++) {
      const Net& net = nets_[blocks[k][lane]];
      for (std::size_t i = 0; i < bodies; i++) out.list[rows + i * width + lane] = net.bodies[i];
      for (std::size_t i = 0; i < springs; i++) out.list[rows + (bodies + i) * width + lane] = net.springs[i];
    }
    out.slots += bodies + springs;
  }
}

}  // namespace pcphys
