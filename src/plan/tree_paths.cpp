#include "plan/tree_paths.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

#include "plan/coloring.h"

namespace pcphys {

void TreeNodes::build(const Forest& forest, std::span<const double> masses, std::span<const std::uint32_t> closings) {
  node_.assign(masses.size(), 0);
  large_.assign(masses.size(), false);
  unit_.resize(masses.size());
  std::iota(unit_.begin(), unit_.end(), 0u);
  parent_.assign(1, 0);
  root_.assign(1, 0);
  level_.assign(1, 0);
  for (std::size_t i = 0; i < forest.trees(); i++) {
    const std::span<const TreeNode> tree = forest.tree(i);
    const std::uint32_t root = rows();
    const bool large = closings.empty() ? tree.size() > largest_tree : tree.size() * closings[i] > most_loop_visits;
    const std::uint32_t unit = tree[masses[tree[0].body] > 0 ? 0 : 1].body;
    for (std::uint32_t k = 0; k < tree.size(); k++) {
      parent_.push_back(k == 0 ? 0 : root + tree[k].parent);
      root_.push_back(root);
      level_.push_back(k == 0 ? 0 : level_[root + tree[k].parent] + 1);
      if (masses[tree[k].body] == 0) continue;
      large_[tree[k].body] = large;
      if (large) continue;
      node_[tree[k].body] = root + k;
      unit_[tree[k].body] = unit;
    }
  }
}

namespace {

/// The two ends of a contact on their way up.
struct Ends {
  std::array<std::uint32_t, 2> own, root, below;  // below: levels under the common node
  std::uint32_t common = 0;
  std::uint32_t shared = 0;  // levels of both ways from the root to the common node, itself with them
};

Ends ends_of(const TreeNodes& nodes, std::uint32_t a, std::uint32_t b) {
  Ends e{{nodes.node(a), nodes.node(b)}, {}, {0, 0}};
  for (std::size_t side = 0; side < 2; side++) e.root[side] = nodes.root(e.own[side]);
  if (e.root[0] == 0 || e.root[0] != e.root[1]) return e;
  std::array<std::uint32_t, 2> at = e.own;
  while (at[0] != at[1]) {
    const std::size_t lower = nodes.level(at[0]) < nodes.level(at[1]) ? 1 : 0;
    at[lower] = nodes.parent(at[lower]);
  }
  e.common = at[0];
  e.shared = nodes.level(e.common) + 1;
  for (std::size_t side = 0; side < 2; side++) e.below[side] = nodes.level(e.own[side]) - nodes.level(e.common);
  return e;
}

constexpr std::uint32_t widest = 64;        // backend, and more
constexpr std::uint32_t fixed_entries = 7;  // PATH_LEVELS of tree_path.inl

/// Levels of the ways of a block: the longest of its lanes.
struct Levels {
  std::array<std::uint32_t, 2> depth{}, below{}, any{};  // any: 1 where some lane's side stands in a tree
  std::uint32_t shared = 0;
  /// Entries that list shared slots: of the root two.
  std::uint32_t shared_slots() const { return shared == 0 ? 0 : shared + 1; }
  std::uint32_t all() const { return depth[0] + depth[1] + below[0] + below[1] + shared_slots(); }
  /// Of how the sides meet; of impulses, and as many of couples.
  std::uint32_t reach_slots() const { return 2 + 2 * (2 * (any[0] + any[1]) + depth[0] + depth[1]); }
};

}  // namespace

std::uint16_t path_kind(const TreeNodes& nodes, std::uint32_t a, std::uint32_t b, bool turns, bool idle) {
  const std::uint32_t node_a = nodes.node(a), node_b = nodes.node(b);
  if (node_a == 0 && node_b == 0) return 0;
  constexpr std::uint32_t most = 7;  // steps told apart: to no tree, to a root, one level below, ...
  const auto steps = [&](std::uint32_t node) { return node == 0 ? 0 : std::min(nodes.level(node) + 1, most); };
  const bool within = nodes.unit(a) == nodes.unit(b);
  const std::uint32_t length = steps(node_a) * (most + 1) + steps(node_b);
  return std::uint16_t(Colouring::first_leading + (idle * 4 + turns * 2 + within) * (most + 1) * (most + 1) + length);
}

std::uint32_t pack_paths(const TreeNodes& nodes, std::uint32_t width, std::uint32_t blocks,
                         std::span<const std::uint32_t> ends, std::vector<std::uint32_t>& out) {
  assert(width <= widest && ends.size() >= std::size_t{2} * blocks * width);
  const auto end = [&](std::uint32_t block, std::uint32_t lane, std::uint32_t side) {
    return ends[(std::size_t{block} * 2 + side) * width + lane];
  };
  constexpr std::uint32_t head = 8;
  out.assign(blocks, 0);
  std::uint32_t reach = 0;
  std::array<Ends, widest> lanes;
  for (std::uint32_t block = 0; block < blocks; block++) {
    Levels levels;
    for (std::uint32_t lane = 0; lane < width; lane++) {
      const Ends& e = lanes[lane] = ends_of(nodes, end(block, lane, 0), end(block, lane, 1));
      for (std::size_t side = 0; side < 2; side++) {
        levels.depth[side] = std::max(levels.depth[side], nodes.level(e.own[side]));
        levels.below[side] = std::max(levels.below[side], e.below[side]);
        levels.any[side] |= e.own[side] != 0;
      }
      levels.shared = std::max(levels.shared, e.shared);
    }
    const std::size_t at = out.size();
    out[block] = std::uint32_t(at);
    out.resize(at + head + std::size_t{width} * (fixed_entries + levels.all()), 0);
    for (std::size_t side = 0; side < 2; side++) {
      out[at + side] = levels.depth[side];
      out[at + 2 + side] = levels.below[side];
      out[at + 4 + side] = levels.any[side];
    }
    out[at + 6] = levels.shared;
    out[at + 7] = reach;
    reach += levels.reach_slots();
    std::uint32_t* entries = out.data() + at + head;
    for (std::uint32_t lane = 0; lane < width; lane++) {
      const Ends& e = lanes[lane];
      const auto put = [&](std::uint32_t entry, std::uint32_t value) { entries[entry * width + lane] = value; };
      /// The last `count` levels of a side's way, from entry `first` on.
      const auto put_way = [&](std::size_t side, std::uint32_t first, std::uint32_t count) {
        std::uint32_t node = e.own[side];
        for (std::uint32_t level = count; level-- > 0; node = nodes.parent(node)) put(first + level, node);
      };
      std::uint32_t entry = fixed_entries;
      for (std::uint32_t side = 0; side < 2; side++) {
        put(side, end(block, lane, side));
        put(2 + side, e.root[side]);
        put(4 + side, e.own[side]);
        put_way(side, entry, nodes.level(e.own[side]));
        entry += levels.depth[side];
      }
      for (std::uint32_t side = 0; side < 2; side++) {
        put_way(side, entry, e.below[side]);
        entry += levels.below[side];
      }
      put(6, e.common);
      for (std::uint32_t i = 0; e.shared > 0 && i <= e.shared; i++) put(entry + i, e.root[0]);
    }
  }
  return reach;
}

}  // namespace pcphys
