// Pins the forest of joint trees: what is a root, what is a tree, which joints are left over, and that the order in
// which joints are given does not matter.
#include "support_forest.h"

using namespace forest_test;

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
  CHECK_FALSE(f.has_loop(0));
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
    // from both of the ground's joints at once
    REQUIRE(f.trees() == 2);
    CHECK(bodies(f, 0) == List{0, left, bar});
    CHECK(bodies(f, 1) == List{0, right});
    CHECK(closing(f) == List{3});
    CHECK(f.has_loop(0));
    CHECK(f.has_loop(1));
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

TEST_CASE("forest: a chain between two fixed bodies is two halves and one joint over") {
  Graph g;
  const auto post = g.body(0);
  std::uint32_t above = 0;
  for (int i = 0; i < 4; i++) {
    const auto link = g.body(1);
    g.join(above, link);
    above = link;
  }
  g.join(above, post);
  const Forest f = g.forest();
  check_forest(g, f);
  CHECK(f.trees() == 2);
  CHECK(bodies(f, 0).size() == 3);
  CHECK(bodies(f, 1).size() == 3);
  CHECK(closing(f) == List{3});
}

TEST_CASE("forest: a net hangs from each of its anchors, row by row") {
  Graph g;
  const std::uint32_t columns = 5, rows = 6;
  List column_of{0}, above(columns, 0);
  for (std::uint32_t row = 0; row < rows; row++) {
    std::uint32_t left = 0;
    for (std::uint32_t column = 0; column < columns; column++) {
      const auto knot = g.body(1);
      column_of.push_back(column);
      g.join(above[column], knot);
      if (left) g.join(left, knot);
      above[column] = left = knot;
    }
  }
  const Forest f = g.forest();
  check_forest(g, f);
  REQUIRE(f.trees() == columns);
  for (std::uint32_t column = 0; column < columns; column++) {
    REQUIRE(f.tree(column).size() == rows + 1);
    for (std::size_t k = 1; k <= rows; k++) CHECK(column_of[f.tree(column)[k].body] == column);
  }
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
