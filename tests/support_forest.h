// What the tests of joint trees share: graphs of joints, random ones, and what holds of every forest.
#pragma once
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "plan/forest.h"

namespace forest_test {
using namespace pcphys;

/// Joints and masses of a small world; body 0 is the ground. Rows, ids and places in the list are the same unless a
/// test says otherwise.
struct Graph {
  std::vector<double> masses{0};
  std::vector<JointLink> links;

  std::uint32_t body(double mass) {
    masses.push_back(mass);
    return std::uint32_t(masses.size() - 1);
  }
  std::uint32_t join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t row = std::uint32_t(links.size() + 1);
    links.push_back({row, a, b, row});
    return row;
  }
  Forest forest() const {
    std::vector<std::uint32_t> ids(masses.size());
    for (std::uint32_t i = 0; i < ids.size(); i++) ids[i] = i;
    Forest f;
    f.build(links, masses, ids);
    return f;
  }
};

inline std::vector<std::uint32_t> bodies(const Forest& f, std::size_t tree) {
  std::vector<std::uint32_t> rows;
  for (const TreeNode& node : f.tree(tree)) rows.push_back(node.body);
  return rows;
}
inline std::vector<std::uint32_t> parents(const Forest& f, std::size_t tree) {
  std::vector<std::uint32_t> places;
  for (const TreeNode& node : f.tree(tree)) places.push_back(node.parent);
  return places;
}
inline std::vector<std::uint32_t> closing(const Forest& f) { return {f.closing().begin(), f.closing().end()}; }
using List = std::vector<std::uint32_t>;

inline bool equal(const Forest& f, const Forest& g) {
  const auto same = [](const TreeNode& a, const TreeNode& b) {
    return a.body == b.body && a.joint == b.joint && a.parent == b.parent && a.flipped == b.flipped;
  };
  if (f.trees() != g.trees() || closing(f) != closing(g)) return false;
  for (std::size_t i = 0; i < f.trees(); i++)
    if (!std::ranges::equal(f.tree(i), g.tree(i), same)) return false;
  return true;
}

/// What holds of every forest: trees are trees of the graph's own joints, no joint and no body that moves stands twice,
/// and what is left over would close a loop.
inline void check_forest(const Graph& graph, const Forest& f) {
  std::map<std::uint32_t, const JointLink*> by_row;
  for (const JointLink& l : graph.links) by_row[l.row] = &l;
  std::map<std::uint32_t, std::size_t> tree_of;  // bodies that move
  std::set<std::uint32_t> joints;
  for (std::size_t t = 0; t < f.trees(); t++) {
    const auto nodes = f.tree(t);
    REQUIRE(nodes.size() >= 2);
    CHECK(nodes[0].joint == 0);
    for (std::size_t k = 0; k < nodes.size(); k++) {
      const TreeNode& n = nodes[k];
      const bool moves = graph.masses[n.body] > 0;
      CHECK((moves || k == 0));
      if (moves) CHECK(tree_of.emplace(n.body, t).second);
      if (k == 0) continue;
      CHECK(n.parent < k);
      CHECK(n.parent >= (k > 1 ? nodes[k - 1].parent : 0));  // breadth first
      CHECK(joints.insert(n.joint).second);
      const JointLink& l = *by_row.at(n.joint);
      CHECK((n.flipped ? l.a : l.b) == n.body);
      CHECK((n.flipped ? l.b : l.a) == nodes[n.parent].body);
      // the root of a free tree is the heaviest
      if (graph.masses[nodes[0].body] > 0) CHECK(graph.masses[nodes[0].body] >= graph.masses[n.body]);
    }
  }
  for (std::uint32_t row : f.closing()) {
    CHECK(joints.insert(row).second);
    const JointLink& l = *by_row.at(row);
    const bool moves_a = graph.masses[l.a] > 0, moves_b = graph.masses[l.b] > 0;
    if (moves_a && moves_b && tree_of.at(l.a) != tree_of.at(l.b))  // two that hang, each from the anchor that is nearer
      for (std::uint32_t body : {l.a, l.b}) CHECK(graph.masses[f.tree(tree_of.at(body))[0].body] == 0);
    // what else holds a body to something fixed: its tree has such a root already
    if (moves_a != moves_b) CHECK(graph.masses[f.tree(tree_of.at(moves_a ? l.a : l.b))[0].body] == 0);
  }
  CHECK(joints.size() == graph.links.size());
  CHECK(std::ranges::is_sorted(f.closing()));
}

/// Mostly trees, some loops, some fixed bodies, some joints twice.
inline Graph random_graph(std::mt19937& random) {
  const auto below = [&](std::uint32_t n) { return std::uint32_t(random() % n); };
  Graph g;
  const std::uint32_t count = 2 + below(30);
  const double masses[] = {0, 1, 1, 1, 2, 3.5, 1e6};
  for (std::uint32_t i = 0; i < count; i++) g.body(masses[below(7)]);
  std::uint32_t joints = below(count + count / 2);
  while (joints-- > 0) {
    const std::uint32_t a = below(count + 1), b = below(count + 1);
    if (a != b) g.join(a, b);
  }
  return g;
}

}  // namespace forest_test
