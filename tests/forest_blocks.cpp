// Pins how joint trees lie in blocks of lanes: trees of one shape share blocks, and what is left over is padding.
#include "support_forest.h"

using namespace forest_test;

namespace {

constexpr std::uint32_t widths[] = {1, 4, 8, 32};

TreeShapes shapes_of(const Forest& forest) {
  TreeShapes shapes;
  shapes.build(forest);
  return shapes;
}

/// What a work group goes by that shares a tree: spans cover all nodes in their order, each of one level that has
/// several, or of levels of one each, of which as many as follow each other; groups are all children of a node, and
/// begin where spans do.
void check_levels(const TreeBlocks& blocks, std::uint32_t block) {
  const std::uint32_t first = blocks.blocks[3 * block], count = blocks.blocks[3 * block + 1],
                      at = blocks.blocks[3 * block + 2];
  REQUIRE(at >= 3 * blocks.count());
  const std::uint32_t spans = blocks.blocks.at(at), groups = blocks.blocks.at(at + 2 + 2 * spans) >> 1;
  const auto node = [&](std::uint32_t s) { return blocks.blocks.at(at + 1 + 2 * s); };
  const auto group = [&](std::uint32_t s) { return blocks.blocks.at(at + 2 + 2 * s) >> 1; };
  const auto is_chain = [&](std::uint32_t s) { return (blocks.blocks.at(at + 2 + 2 * s) & 1) != 0; };
  const auto group_node = [&](std::uint32_t g) { return blocks.blocks.at(at + 3 + 2 * spans + g); };
  const auto parent = [&](std::uint32_t k) { return blocks.parents[first + k] >> 1; };
  std::vector<std::uint32_t> level(count, 0), width(count, 0);
  for (std::uint32_t k = 1; k < count; k++) level[k] = level[parent(k)] + 1;
  for (const std::uint32_t l : level) width[l]++;
  CHECK((node(0) == 0 && node(1) == 1 && node(spans) == count && !is_chain(0)));
  for (std::uint32_t s = 1; s < spans; s++) {
    REQUIRE(node(s) < node(s + 1));
    CHECK(group_node(group(s)) == node(s));
    for (std::uint32_t k = node(s); k < node(s + 1); k++)
      CHECK((is_chain(s) ? width[level[k]] == 1 : width[level[k]] > 1 && level[k] == level[node(s)]));
    if (!is_chain(s)) CHECK(node(s + 1) - node(s) == width[level[node(s)]]);
    CHECK(!(is_chain(s) && s > 1 && is_chain(s - 1)));
  }
  CHECK((group_node(0) == 1 && group_node(groups) == count));
  for (std::uint32_t g = 0; g < groups; g++) {
    for (std::uint32_t k = group_node(g); k < group_node(g + 1); k++) CHECK(parent(k) == parent(group_node(g)));
    CHECK((g == 0 || parent(group_node(g)) > parent(group_node(g - 1))));
  }
}

/// Every tree stands in one lane of one block of its shape, in the order of the forest among those of its shape; all
/// other lanes hold rows 0, and no block could have been left out.
void check_blocks(const Forest& f, std::uint32_t width, const TreeBlocks& blocks) {
  REQUIRE(blocks.blocks.size() >= 3 * blocks.count());
  REQUIRE(blocks.ends.size() == blocks.parents.size() * 2 * width);
  std::vector<char> placed(f.trees(), 0);
  std::map<List, std::size_t> last_of_shape, room;  // the last tree seen of a shape; free lanes of its last block
  std::uint32_t next = 0;
  for (std::uint32_t b = 0; b < blocks.count(); b++) {
    const std::uint32_t first = blocks.blocks[3 * b], count = blocks.blocks[3 * b + 1];
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
  if (width > 1) CHECK(blocks.blocks.size() == 3 * blocks.count());
  for (std::uint32_t b = 0; b < blocks.count() && width == 1; b++) check_levels(blocks, b);
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
    pack_trees(f, shapes_of(f), width, blocks);
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
  pack_trees(g.forest(), shapes_of(g.forest()), 4, blocks);
  CHECK(blocks.count() == 2);
  CHECK(blocks.parents == List{0, 0, 0, 1});
}

TEST_CASE("tree blocks: of no trees none") {
  TreeBlocks blocks;
  blocks.blocks = blocks.parents = blocks.ends = {1, 2};
  pack_trees(Graph{}.forest(), {}, 8, blocks);
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
      pack_trees(f, shapes_of(f), width, blocks);
      check_blocks(f, width, blocks);
    }
  }
}

TEST_CASE("tree blocks: octaves have blocks of their own, lowest first") {
  Graph g;
  for (int tree = 0; tree < 5; tree++) g.join(g.body(1), g.body(1));
  const Forest f = g.forest();
  const std::vector<std::uint8_t> octaves = {1, 0, 1, 2, 0};
  TreeBlocks blocks;
  pack_trees(f, shapes_of(f), 4, blocks, {octaves, 4});
  REQUIRE(blocks.count() == 3);
  REQUIRE(blocks.ranges.size() == 4);
  const std::uint32_t ends[] = {1, 2, 3, 3};
  for (std::size_t octave = 0; octave < 4; octave++) CHECK(blocks.ranges[octave].end == ends[octave]);
  CHECK(blocks.order[0] == 1 + f.first(1));
  CHECK(blocks.order[1] == 1 + f.first(4));
  CHECK(blocks.order[2] == 0);
  CHECK(blocks.order[2 * 4] == 1 + f.first(0));
  CHECK(blocks.order[4 * 4] == 1 + f.first(3));
}
