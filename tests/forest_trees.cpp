// Pins the forest of joint trees: what is a root, what is a tree, which joints are left over, that the order in which
// joints are given does not matter, and how trees lie in blocks of lanes.
#include "plan/forest.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>

using namespace pcphys;

namespace {

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

std::vector<std::uint32_t> bodies(const Forest& f, std::size_t tree) {
  std::vector<std::uint32_t> rows;
  for (const TreeNode& node : f.tree(tree)) rows.push_back(node.body);
  return rows;
}
std::vector<std::uint32_t> parents(const Forest& f, std::size_t tree) {
  std::vector<std::uint32_t> places;
  for (const TreeNode& node : f.tree(tree)) places.push_back(node.parent);
  return places;
}
std::vector<std::uint32_t> closing(const Forest& f) { return {f.closing().begin(), f.closing().end()}; }
using List = std::vector<std::uint32_t>;

bool equal(const Forest& f, const Forest& g) {
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
void check_forest(const Graph& graph, const Forest& f) {
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
    if (moves_a && moves_b) CHECK(tree_of.at(l.a) == tree_of.at(l.b));
    // what else holds a body to something fixed: its tree has such a root already
    if (moves_a != moves_b) CHECK(graph.masses[f.tree(tree_of.at(moves_a ? l.a : l.b))[0].body] == 0);
  }
  CHECK(joints.size() == graph.links.size());
  CHECK(std::ranges::is_sorted(f.closing()));
}

}  // namespace

TEST_CASE("forest: nothing, and no joints") {
  Graph g;
  CHECK(g.forest().trees() == 0);
  g.body(1);
  CHECK(g.forest().trees() == 0);
  CHECK(closing(g.forest()).empty());
  CHECK(Forest{}.trees() == 0);
}

TEST_CASE("forest: a chain that hangs has the fixed body as its root") {
  Graph g;
  std::uint32_t above = 0;
  for (int i = 0; i < 5; i++) {
    const std::uint32_t link = g.body(i == 4 ? 1000 : 1);  // a heavy load does not matter here
    if (i % 2)
      g.join(link, above);
    else
      g.join(above, link);
    above = link;
  }
  const Forest f = g.forest();
  check_forest(g, f);
  REQUIRE(f.trees() == 1);
  CHECK(bodies(f, 0) == List{0, 1, 2, 3, 4, 5});
  CHECK(parents(f, 0) == List{0, 0, 1, 2, 3, 4});
  for (std::uint32_t k = 1; k <= 5; k++) {
    CHECK(f.tree(0)[k].joint == k);
    CHECK(f.tree(0)[k].flipped == (k % 2 == 0));
  }
  CHECK(closing(f).empty());
}

TEST_CASE("forest: a free tree has its heaviest body as its root, of equal ones that of the lowest id") {
  Graph g;
  for (double mass : {1.0, 2.0, 5.0, 5.0, 1.0}) g.body(mass);
  for (std::uint32_t i = 1; i < 5; i++) g.join(i, i + 1);
  Forest f = g.forest();
  check_forest(g, f);
  REQUIRE(f.trees() == 1);
  CHECK(bodies(f, 0) == List{3, 2, 4, 1, 5});
  CHECK(parents(f, 0) == List{0, 0, 0, 1, 2});
  CHECK(f.tree(0)[1].flipped);
  CHECK_FALSE(f.tree(0)[2].flipped);
  // ids, not rows
  const List ids{0, 1, 2, 9, 3, 4};
  f.build(g.links, g.masses, ids);
  CHECK(f.tree(0)[0].body == 4);
}

TEST_CASE("forest: a loop leaves one joint over") {
  SUBCASE("a four-bar linkage: two arms on the ground and a bar between them") {
    Graph g;
    const auto left = g.body(1), bar = g.body(1), right = g.body(1);
    g.join(0, left), g.join(left, bar), g.join(bar, right), g.join(0, right);
    const Forest f = g.forest();
    check_forest(g, f);
    // two trees grow from the ground's joints only if nothing reached the second arm first
    REQUIRE(f.trees() == 1);
    CHECK(bodies(f, 0) == List{0, left, bar, right});
    CHECK(closing(f) == List{4});
  }
  SUBCASE("a ring of six") {
    Graph g;
    for (int i = 0; i < 6; i++) g.body(1);
    for (std::uint32_t i = 1; i <= 6; i++) g.join(i, i % 6 + 1);
    const Forest f = g.forest();
    check_forest(g, f);
    REQUIRE(f.trees() == 1);
    CHECK(bodies(f, 0) == List{1, 2, 6, 3, 5, 4});  // from both sides of the lowest id
    CHECK(closing(f) == List{4});
  }
}

TEST_CASE("forest: a body on two pins") {
  Graph g;
  const auto door = g.body(10);
  SUBCASE("both to the ground") {
    g.join(0, door), g.join(0, door);
    CHECK(closing(g.forest()) == List{2});
  }
  SUBCASE("to two fixed bodies") {
    const auto post = g.body(0);
    g.join(post, door), g.join(0, door);
    const Forest f = g.forest();
    CHECK(bodies(f, 0) == List{post, door});  // that of the lower id
    CHECK(closing(f) == List{2});
  }
  SUBCASE("two pins between the same two bodies") {
    const auto other = g.body(1);
    g.join(other, door), g.join(door, other);
    const Forest f = g.forest();
    CHECK(bodies(f, 0) == List{door, other});
    CHECK(f.tree(0)[1].flipped);
    CHECK(closing(f) == List{2});
  }
  const Forest f = g.forest();
  check_forest(g, f);
  CHECK(f.trees() == 1);
}

TEST_CASE("forest: a chain between two fixed bodies is one tree and one joint over") {
  Graph g;
  const auto post = g.body(0);
  std::uint32_t above = 0;
  for (int i = 0; i < 4; i++) {
    const auto link = g.body(1);
    g.join(above, link);
    above = link;
  }
  const auto last = g.join(above, post);
  const Forest f = g.forest();
  check_forest(g, f);
  CHECK(f.trees() == 1);
  CHECK(closing(f) == List{last});
}

TEST_CASE("forest: one fixed body is the root of several trees, and joints between fixed bodies are in none") {
  Graph g;
  const auto a = g.body(1), b = g.body(1), below = g.body(3), kinematic = g.body(0);
  g.join(0, a), g.join(0, b), g.join(b, below);
  const auto nothing = g.join(kinematic, 0);
  const Forest f = g.forest();
  check_forest(g, f);
  REQUIRE(f.trees() == 2);
  CHECK(bodies(f, 0) == List{0, a});
  CHECK(bodies(f, 1) == List{0, b, below});
  CHECK(closing(f) == List{nothing});
}

TEST_CASE("forest: a fixed body between two others does not join them") {
  Graph g;
  const auto a = g.body(1), wall = g.body(0), b = g.body(1);
  g.join(a, wall), g.join(wall, b);
  const Forest f = g.forest();
  check_forest(g, f);
  CHECK(f.trees() == 2);
  CHECK(closing(f).empty());
}

namespace {

/// Mostly trees, some loops, some fixed bodies, some joints twice.
Graph random_graph(std::mt19937& random) {
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

}  // namespace

TEST_CASE("forest: random graphs, and the order of links does not matter") {
  std::mt19937 random(11);
  Forest again;  // one that has built others before
  for (int i = 0; i < 2000; i++) {
    const Graph g = random_graph(random);
    CAPTURE(i);
    const Forest f = g.forest();
    check_forest(g, f);
    Graph mixed = g;
    std::shuffle(mixed.links.begin(), mixed.links.end(), random);
    CHECK(equal(f, mixed.forest()));
    List ids(g.masses.size());
    for (std::uint32_t k = 0; k < ids.size(); k++) ids[k] = k;
    again.build(mixed.links, g.masses, ids);
    CHECK(equal(f, again));
  }
}

// ---- blocks ---------------------------------------------------------------------------------------------

namespace {

constexpr std::uint32_t widths[] = {1, 4, 8, 32};

/// Every tree stands in one lane of one block of its shape, in the order of the forest among those of its shape; all
/// other lanes hold rows 0, and no block could have been left out.
void check_blocks(const Forest& f, std::uint32_t width, const TreeBlocks& blocks) {
  REQUIRE(blocks.blocks.size() == 2 * blocks.count());
  REQUIRE(blocks.ends.size() == blocks.parents.size() * 2 * width);
  std::vector<char> placed(f.trees(), 0);
  std::map<List, std::size_t> last_of_shape, room;  // the last tree seen of a shape; free lanes of its last block
  std::uint32_t next = 0;
  for (std::uint32_t b = 0; b < blocks.count(); b++) {
    const std::uint32_t first = blocks.blocks[2 * b], count = blocks.blocks[2 * b + 1];
    CHECK(first == next);
    next = first + count;
    const List shape(blocks.parents.begin() + first, blocks.parents.begin() + next);
    CHECK((!room.contains(shape) || room[shape] == 0));  // the one before is full
    room[shape] = 0;
    const auto at = [&](std::uint32_t k, std::uint32_t side, std::uint32_t lane) {
      return blocks.ends[((first + k) * 2 + side) * width + lane];
    };
    for (std::uint32_t lane = 0; lane < width; lane++) {
      if (at(1, 1, lane) == 0) {
        for (std::uint32_t k = 0; k < count; k++) CHECK((at(k, 0, lane) == 0 && at(k, 1, lane) == 0));
        room[shape]++;
        continue;
      }
      CHECK(room[shape] == 0);  // padding stands last
      std::size_t tree = 0;
      while (tree < f.trees() && f.tree(tree)[1].joint != at(1, 1, lane)) tree++;
      REQUIRE(tree < f.trees());
      CHECK(!placed[tree]);
      placed[tree] = 1;
      CHECK((!last_of_shape.contains(shape) || last_of_shape[shape] < tree));
      last_of_shape[shape] = tree;
      REQUIRE(f.tree(tree).size() == count);
      for (std::uint32_t k = 0; k < count; k++) {
        const TreeNode& node = f.tree(tree)[k];
        CHECK(at(k, 0, lane) == node.body);
        CHECK(at(k, 1, lane) == node.joint);
        CHECK(shape[k] == (node.parent << 1 | std::uint32_t(node.flipped)));
      }
    }
    CHECK(room[shape] < width);  // not all padding
  }
  CHECK(next == blocks.parents.size());
  CHECK(std::ranges::count(placed, 0) == 0);
}

/// A body with `bones` others on it, two of them in a row.
void add_ragdoll(Graph& g, int bones) {
  const std::uint32_t hips = g.body(5);
  std::uint32_t last = hips;
  for (int i = 0; i < bones; i++) {
    const std::uint32_t bone = g.body(1);
    g.join(i % 2 ? last : hips, bone);
    last = bone;
  }
}

}  // namespace

TEST_CASE("tree blocks: equal ragdolls share blocks, whatever else there is") {
  Graph g;
  for (int i = 0; i < 5; i++) {
    add_ragdoll(g, 11);
    add_ragdoll(g, 3);
  }
  const Forest f = g.forest();
  check_forest(g, f);
  REQUIRE(f.trees() == 10);
  for (const std::uint32_t width : widths) {
    CAPTURE(width);
    TreeBlocks blocks;
    pack_trees(f, width, blocks);
    check_blocks(f, width, blocks);
    const std::uint32_t of_each = (5 + width - 1) / width;
    CHECK(blocks.count() == 2 * of_each);
    CHECK(blocks.parents.size() == of_each * (12 + 4));
  }
}

TEST_CASE("tree blocks: the side of a joint's bodies is part of a shape") {
  Graph g;
  for (int i = 0; i < 2; i++) {
    const auto a = g.body(2), b = g.body(1);
    i == 0 ? g.join(a, b) : g.join(b, a);
  }
  TreeBlocks blocks;
  pack_trees(g.forest(), 4, blocks);
  CHECK(blocks.count() == 2);
  CHECK(blocks.parents == List{0, 0, 0, 1});
}

TEST_CASE("tree blocks: of no trees none") {
  TreeBlocks blocks;
  blocks.blocks = blocks.parents = blocks.ends = {1, 2};
  pack_trees(Graph{}.forest(), 8, blocks);
  CHECK(blocks.count() == 0);
  CHECK(blocks.parents.empty());
  CHECK(blocks.ends.empty());
}

TEST_CASE("tree blocks: random graphs") {
  std::mt19937 random(12);
  TreeBlocks blocks;
  for (int i = 0; i < 500; i++) {
    Graph g;
    // several small ones side by side, so that shapes repeat
    for (int part = 0; part < 12; part++) {
      const Graph small = random_graph(random);
      const std::uint32_t shift = std::uint32_t(g.masses.size()) - 1;
      for (std::size_t k = 1; k < std::min<std::size_t>(small.masses.size(), 5); k++) g.body(small.masses[k]);
      for (const JointLink& l : small.links)
        if (l.a < 5 && l.b < 5) g.join(l.a ? l.a + shift : 0, l.b ? l.b + shift : 0);
    }
    const Forest f = g.forest();
    CAPTURE(i);
    check_forest(g, f);
    for (const std::uint32_t width : widths) {
      pack_trees(f, width, blocks);
      check_blocks(f, width, blocks);
    }
  }
}
