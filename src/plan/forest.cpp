#include "plan/forest.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace pcphys {

void Forest::build(std::span<const JointLink> links, std::span<const double> masses,
                   std::span<const std::uint32_t> ids) {
  links_.assign(links.begin(), links.end());
  std::ranges::sort(links_, {}, &JointLink::id);
  masses_.assign(masses.begin(), masses.end());
  begin_.assign(masses.size() + 1, 0);
  for (const JointLink& l : links_)
    if (!l.yields) begin_[l.a + 1]++, begin_[l.b + 1]++;
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  links_of_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t i = 0; i < links_.size(); i++)
    if (!links_[i].yields) links_of_[next[links_[i].a]++] = i, links_of_[next[links_[i].b]++] = i;

  reached_.assign(masses.size(), 0);
  used_.assign(links_.size(), 0);
  nodes_.clear();
  first_.assign(1, 0);
  grow_hanging();
  // free ones, from their heaviest body; of equal ones from the lowest id
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < masses.size(); row++)
    if (masses[row] > 0 && !reached_[row] && begin_[row] != begin_[row + 1]) rows.push_back(row);
  std::ranges::sort(rows, [&](std::uint32_t x, std::uint32_t y) {
    return masses[x] != masses[y] ? masses[x] > masses[y] : ids[x] < ids[y];
  });
  for (const std::uint32_t row : rows)
    if (!reached_[row]) {
      reached_[row] = 1;
      trees_.assign(1, {{row, 0, 0, false}});
      grow();
    }

  closing_.clear();
  std::vector<char> closes(masses.size(), 0);  // by body row: a joint of it closes a loop
  for (std::uint32_t i = 0; i < links_.size(); i++)
    if (!used_[i]) {
      closing_.push_back(links_[i].row);
      closes[links_[i].a] = closes[links_[i].b] = 1;
    }
  std::ranges::sort(closing_);
  if (closing_.empty()) return;
  for (std::size_t i = 0; i < trees(); i++)
    for (std::uint32_t k = first_[i]; k < first_[i + 1]; k++)
      if (closes[nodes_[k].body] && masses_[nodes_[k].body] > 0) nodes_[first_[i]].parent = 1;
}

void Forest::grow_hanging() {
  trees_.clear();
  for (std::uint32_t i = 0; i < links_.size(); i++) {
    const JointLink& l = links_[i];
    const bool fixed_a = masses_[l.a] == 0, fixed_b = masses_[l.b] == 0;
    const std::uint32_t anchor = fixed_a ? l.a : l.b, child = fixed_a ? l.b : l.a;
    if (l.yields || fixed_a == fixed_b || reached_[child]) continue;
    used_[i] = reached_[child] = 1;
    trees_.push_back({{anchor, 0, 0, false}, {child, l.row, 0, l.a == child}});
  }
  grow();
}

void Forest::grow() {
  const auto visit = [&](std::vector<TreeNode>& tree, std::size_t at, std::uint32_t link) {
    const JointLink& l = links_[link];
    const std::uint32_t child = l.a == tree[at].body ? l.b : l.a;
    if (used_[link] || masses_[child] == 0 || reached_[child]) return;
    used_[link] = reached_[child] = 1;
    tree.push_back({child, l.row, std::uint32_t(at), l.a == child});
  };
  std::vector<std::size_t> done(trees_.size(), 0);
  for (bool grows = true; grows;) {
    grows = false;
    for (std::size_t i = 0; i < trees_.size(); i++)
      for (std::size_t level = trees_[i].size(); done[i] < level; done[i]++) {
        grows = true;
        const std::uint32_t body = trees_[i][done[i]].body;
        if (masses_[body] == 0) continue;  // what hangs there beside is a tree of its own
        for (std::uint32_t at = begin_[body]; at < begin_[body + 1]; at++) visit(trees_[i], done[i], links_of_[at]);
      }
  }
  for (const std::vector<TreeNode>& tree : trees_) {
    nodes_.insert(nodes_.end(), tree.begin(), tree.end());
    first_.push_back(std::uint32_t(nodes_.size()));
  }
}

void TreeShapes::build(const Forest& forest) {
  std::map<std::vector<std::uint32_t>, std::size_t> shapes;  // parents and sides of all nodes
  std::vector<std::vector<std::uint32_t>> alike;
  std::vector<std::uint32_t> shape;
  for (std::uint32_t i = 0; i < forest.trees(); i++) {
    shape.clear();
    for (const TreeNode& node : forest.tree(i)) shape.push_back(node.parent << 1 | std::uint32_t(node.flipped));
    const auto [at, is_new] = shapes.try_emplace(shape, alike.size());
    if (is_new) alike.emplace_back();
    alike[at->second].push_back(i);
  }
  trees_.clear();
  begin_.assign(1, 0);
  for (const std::vector<std::uint32_t>& trees : alike) {
    trees_.insert(trees_.end(), trees.begin(), trees.end());
    begin_.push_back(std::uint32_t(trees_.size()));
  }
}

std::uint32_t TreeShapes::most_alike() const {
  std::size_t most = 0;
  for (std::size_t shape = 0; shape < count(); shape++) most = std::max(most, trees(shape).size());
  return std::uint32_t(most);
}

namespace {

/// A block like a tree, of lanes that are padding.
void add_block(std::span<const TreeNode> like, std::uint32_t width, TreeBlocks& out) {
  out.blocks.push_back(std::uint32_t(out.parents.size()));
  out.blocks.push_back(std::uint32_t(like.size()));
  out.blocks.push_back(0);
  for (const TreeNode& node : like) out.parents.push_back(node.parent << 1 | std::uint32_t(node.flipped));
  out.ends.resize(out.parents.size() * 2 * width, 0);
  out.order.resize(out.parents.size() * width, 0);
}

/// Puts a tree into a lane of the last block.
void fill_lane(const Forest& forest, std::uint32_t i, std::uint32_t lane, std::uint32_t width, TreeBlocks& out) {
  const std::span<const TreeNode> tree = forest.tree(i);
  const std::size_t first = out.parents.size() - tree.size();
  for (std::size_t k = 0; k < tree.size(); k++) {
    std::uint32_t* const ends = &out.ends[(first + k) * 2 * width];
    ends[lane] = tree[k].body;
    ends[width + lane] = tree[k].joint;
    out.order[(first + k) * width + lane] = 1 + forest.first(i) + std::uint32_t(k);
  }
}

/// Of a block that is one tree.
void add_levels(std::size_t block, TreeBlocks& out) {
  const std::uint32_t first = out.blocks[3 * block], count = out.blocks[3 * block + 1];
  const auto parent = [&](std::uint32_t k) { return out.parents[first + k] >> 1; };
  const auto is_oldest = [&](std::uint32_t k) { return k == 1 || parent(k) != parent(k - 1); };
  const std::size_t at = out.blocks.size();
  out.blocks[3 * block + 2] = std::uint32_t(at);
  out.blocks.insert(out.blocks.end(), {1, 0, 0});  // the root
  std::uint32_t groups = 0;
  bool in_chain = false;
  for (std::uint32_t begin = 1, end = 1; begin < count; begin = end) {
    const std::uint32_t above = end = begin;
    while (end < count && parent(end) < above) end++;
    const bool is_chain = end - begin == 1;
    if (!is_chain || !in_chain) {
      out.blocks[at]++;
      out.blocks.insert(out.blocks.end(), {begin, groups << 1 | std::uint32_t(is_chain)});
    }
    in_chain = is_chain;
    for (std::uint32_t k = begin; k < end; k++) groups += is_oldest(k);
  }
  out.blocks.insert(out.blocks.end(), {count, groups << 1});
  for (std::uint32_t k = 1; k < count; k++)
    if (is_oldest(k)) out.blocks.push_back(k);
  out.blocks.push_back(count);
}

}  // namespace

void pack_trees(const Forest& forest, const TreeShapes& shapes, std::uint32_t width, TreeBlocks& out, OctaveOf of) {
  out.blocks.clear();
  out.parents.clear();
  out.ends.clear();
  out.order.clear();
  out.ranges.assign(of.count, {0, 0});
  for (unsigned octave = 0; octave < of.count; octave++) {
    out.ranges[octave].begin = std::uint32_t(out.blocks.size() / 3);
    for (std::size_t shape = 0; shape < shapes.count(); shape++) {
      std::uint32_t lane = 0;
      for (const std::uint32_t i : shapes.trees(shape)) {
        if (!of.is(i, octave)) continue;
        if (lane == 0) add_block(forest.tree(i), width, out);
        fill_lane(forest, i, lane, width, out);
        lane = (lane + 1) % width;
      }
    }
    out.ranges[octave].end = std::uint32_t(out.blocks.size() / 3);
  }
  for (std::size_t block = 0; width == 1 && block < out.count(); block++) add_levels(block, out);
}

bool has_limits(const WorldState& state, std::span<const TreeNode> tree) {
  return std::ranges::any_of(tree, [&](const TreeNode& node) {
    return node.joint != 0 && state.joints[node.joint].def.freedom.kind != AngleFreedom::Kind::free;
  });
}

}  // namespace pcphys
