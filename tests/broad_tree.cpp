// The KD-tree's contract: what it answers is what brute force answers, on any arrangement of boxes; its
// depth is bounded; equal input gives equal blocks; boxes that are none never enter.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "broad_support.h"
#include "collision/kd_tree.h"

using namespace broad_test;

namespace {

using Boxes = std::vector<Aabb>;
using PairSet = std::set<std::pair<std::uint32_t, std::uint32_t>>;

std::vector<std::uint32_t> everyone(std::size_t count) {
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

Boxes cloud(std::size_t count, unsigned seed, float x, float y, float z, float half) {
  Random random(seed);
  Boxes boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const float at_x = random(-x, x), at_y = random(-y, y), at_z = random(-z, z);
    boxes.push_back(cube(at_x, at_y, at_z, half * random(0.5f, 1.5f)));
  }
  return boxes;
}

Boxes spread_over_magnitudes(std::size_t count) {
  Random random(7);
  Boxes boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const float size = std::pow(10.0f, random(-6, 6));
    boxes.push_back(cube(size * random(-1, 1), size * random(-1, 1), size * random(-1, 1), 0.1f * size));
  }
  boxes.push_back({{-1e7f, -2, -1e7f}, {1e7f, -1, 1e7f}});
  return boxes;
}

Boxes outliers(std::size_t count) {
  Boxes boxes = cloud(count, 11, 10, 10, 10, 0.3f);
  boxes[3] = cube(1e30f, 0, 0, 1);
  boxes[count / 2] = cube(0, -3e38f, 0, 1e32f);
  boxes[count - 1] = cube(1e30f, 0, 0, 2);
  return boxes;
}

struct Arrangement {
  const char* name;
  Boxes boxes;
};

std::vector<Arrangement> arrangements() {
  Boxes equal(300, cube(1, 2, 3, 0.5f)), points(200, cube(0, 0, 0, 0));
  Boxes planes = cloud(400, 5, 5, 5, 5, 0.4f);
  planes.push_back({{-infinity, -infinity, -infinity}, {infinity, 0, infinity}});
  planes.push_back({{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}});
  planes.push_back({{1, -infinity, 1}, {1, infinity, 1}});
  Boxes many_large = cloud(400, 6, 5, 5, 5, 0.1f);
  for (int i = 0; i < 100; ++i) many_large.push_back(cube(0.1f * static_cast<float>(i), 0, 0, 4));
  Boxes grid;
  for (int i = 0; i < 512; ++i)
    grid.push_back(cube(static_cast<float>(i % 8), static_cast<float>(i / 8 % 8), static_cast<float>(i / 64), 0.5f));
  return {{"none", {}},
          {"one", {cube(0, 0, 0, 1)}},
          {"two", {cube(0, 0, 0, 1), cube(1, 0, 0, 1)}},
          {"three", {cube(0, 0, 0, 1), cube(1, 0, 0, 1), cube(9, 0, 0, 1)}},
          {"cloud", cloud(1000, 1, 10, 10, 10, 0.7f)},
          {"line", cloud(1000, 2, 100, 0, 0, 0.2f)},
          {"slanted line",
           [] {
             Boxes b;
             for (int i = 0; i < 1000; ++i) {
               const float t = 0.1f * static_cast<float>(i);
               b.push_back(cube(t, -t, 2 * t, 0.2f));
             }
             return b;
           }()},
          {"plane", cloud(1000, 3, 20, 0, 20, 0.5f)},
          {"equal", equal},
          {"points", points},
          {"touching grid", grid},
          {"all magnitudes and a ground", spread_over_magnitudes(800)},
          {"outliers", outliers(500)},
          {"planes", planes},
          {"many large", many_large}};
}

PairSet brute_force(const Boxes& boxes) {
  PairSet pairs;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
      if (valid(boxes[i]) && valid(boxes[j]) && overlap(boxes[i], boxes[j])) pairs.insert({i, j});
  return pairs;
}

PairSet pairs_of(const KdTree& tree) {
  PairSet pairs;
  bool once = true;
  tree.pairs([&](std::uint32_t a, std::uint32_t b) {
    once &= pairs.insert({std::min(a, b), std::max(a, b)}).second;
    return true;
  });
  CHECK(once);
  return pairs;
}

// Depth by a sweep from the root; also checks that every block holds what is below it, and every object once.
std::uint32_t checked_depth(const KdTree& tree, std::size_t objects) {
  const auto blocks = tree.blocks();
  std::vector<std::uint32_t> depth(blocks.size(), 0), parents(blocks.size(), 0);
  std::uint32_t deepest = 0;
  bool precede = true, hold = true, filled = true;
  std::set<std::uint32_t> seen;
  std::size_t leaves = 0;
  for (std::size_t i = blocks.size(); i-- > 0;) {
    deepest = std::max(deepest, depth[i]);
    filled &= blocks[i].count >= 1 && blocks[i].count <= BoxBlock::lanes && (blocks[i].leaf || blocks[i].count >= 2);
    for (std::uint32_t l = 0; l < blocks[i].count; ++l) {
      const std::uint32_t child = blocks[i].index[l];
      hold &= contains(tree.bounds(i), blocks[i].box(l));
      if (blocks[i].leaf) {
        seen.insert(child), ++leaves;
        continue;
      }
      precede &= child < i && child >= tree.large().size();
      hold &= contains(blocks[i].box(l), tree.bounds(child));
      depth[child] = depth[i] + 1;
      ++parents[child];
    }
  }
  for (std::size_t i = 0; i < blocks.size(); ++i)
    filled &= parents[i] == (i < tree.large().size() || i + 1 == blocks.size() ? 0 : 1);
  CHECK(precede);
  CHECK(hold);
  CHECK(filled);
  CHECK(seen.size() == leaves);
  CHECK(leaves == objects);
  return deepest;
}

std::size_t large_count(const KdTree& tree) {
  std::size_t count = 0;
  for (const BoxBlock& block : tree.large()) count += block.count;
  return count;
}

}  // namespace

TEST_CASE("tree: pairs are those of brute force") {
  KdTree tree;  // one for all: buffers of one scene must not leak into the next
  for (const Arrangement& arrangement : arrangements()) {
    const Boxes& boxes = arrangement.boxes;
    CAPTURE(arrangement.name);
    tree.build(boxes, everyone(boxes.size()));
    const PairSet expected = brute_force(boxes);
    CHECK(pairs_of(tree) == expected);
    CHECK(tree.count_pairs() == expected.size());
    CHECK(large_count(tree) <= KdTree::max_large + 3);
    CHECK(checked_depth(tree, boxes.size()) <= KdTree::max_depth);
  }
}

TEST_CASE("tree: queries are those of brute force") {
  Random random(21);
  for (const Arrangement& arrangement : arrangements()) {
    const Boxes& boxes = arrangement.boxes;
    CAPTURE(arrangement.name);
    KdTree tree;
    tree.build(boxes, everyone(boxes.size()));
    for (int n = 0; n < 50; ++n) {
      const Aabb box = cube(random(-10, 10), random(-10, 10), random(-10, 10), random(0, 3));
      std::set<std::uint32_t> found, expected;
      tree.query(box, [&](std::uint32_t i) { return found.insert(i).second; });
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        if (overlap(boxes[i], box)) expected.insert(i);
      CHECK(found == expected);
    }
  }
}

TEST_CASE("tree: no pairs of two still objects, nor of two immobile ones") {
  Boxes boxes = cloud(600, 31, 6, 6, 6, 0.6f);
  // large
  for (int i = 0; i < 10; ++i) boxes[60 * i] = {{-50, static_cast<float>(-i), -50}, {50, 0, i < 5 ? 50 : infinity}};
  for (const float moved_share : {0.0f, 0.05f, 0.3f, 1.0f}) {  // few and many are answered in different ways
    CAPTURE(moved_share);
    std::vector<std::uint8_t> flags;
    Random random(32);
    for (std::size_t i = 0; i < boxes.size(); ++i)
      flags.push_back(static_cast<std::uint8_t>((random(0, 1) < moved_share ? 0u : std::uint32_t{KdTree::still}) |
                                                (random(0, 1) < 0.6f ? std::uint32_t{KdTree::mobile} : 0u)));
    KdTree tree;
    tree.build(boxes, everyone(boxes.size()), flags);
    PairSet expected;
    std::size_t mobile = 0;
    for (const auto& [a, b] : brute_force(boxes)) {
      const bool known = flags[a] & flags[b] & KdTree::still;
      if (!known && ((flags[a] | flags[b]) & KdTree::mobile)) expected.insert({a, b});
      mobile += ((flags[a] | flags[b]) & KdTree::mobile) != 0;
    }
    CHECK(pairs_of(tree) == expected);
    CHECK(tree.count_pairs() == mobile);
  }
}

TEST_CASE("tree: a refit answers for the new boxes") {
  Boxes boxes = cloud(700, 41, 8, 8, 8, 0.5f);
  boxes.push_back({{-100, -1, -100}, {100, 0, 100}});
  KdTree tree;
  tree.build(boxes, everyone(boxes.size()));
  CHECK(large_count(tree) == 1);
  Random random(42);
  for (int step = 0; step < 10; ++step) {
    for (Aabb& box : boxes) {
      const float shift = random(-1, 1);
      for (int k = 0; k < 3; ++k) box.min[k] += shift, box.max[k] += shift;
    }
    tree.refit(boxes);
    CHECK(pairs_of(tree) == brute_force(boxes));
    checked_depth(tree, boxes.size());
  }
  CHECK(tree.growth() > 1);
}

TEST_CASE("tree: equal input gives equal blocks, whatever was built before") {
  const Boxes boxes = cloud(3000, 51, 30, 3, 30, 0.5f);
  KdTree first, second;
  second.build(cloud(5000, 52, 1, 1, 1, 0.1f), everyone(5000));
  first.build(boxes, everyone(boxes.size()));
  second.build(boxes, everyone(boxes.size()));
  REQUIRE(first.blocks().size() == second.blocks().size());
  bool same = true;
  for (std::size_t i = 0; i < first.blocks().size(); ++i) {
    const BoxBlock &a = first.blocks()[i], &b = second.blocks()[i];
    same &= a.count == b.count && a.leaf == b.leaf && std::equal(a.index, a.index + a.count, b.index);
    for (std::uint32_t l = 0; l < a.count; ++l) same &= contains(a.box(l), b.box(l)) && contains(b.box(l), a.box(l));
  }
  CHECK(same);
}

TEST_CASE("tree: depth is logarithmic where codes cannot tell objects apart") {
  for (const std::size_t count : {1000u, 4096u, 20000u}) {
    const Boxes boxes(count, cube(1, 2, 3, 0.5f));
    KdTree tree;
    tree.build(boxes, everyone(count));
    CHECK(tree.wide_codes());
    CHECK(checked_depth(tree, boxes.size()) <=
          static_cast<std::uint32_t>(std::ceil(0.5 * std::log2(static_cast<double>(count)))));
  }
}

TEST_CASE("tree: depth stays below 2 log2 n + 8 on lines, planes and in one x, in any order") {
  const std::size_t count = 100000;
  Random random(14);
  Boxes line, plane, same_x;
  for (std::size_t i = 0; i < count; ++i) {
    line.push_back(cube(0.03f * float(i), 0, 0, 0.01f));
    plane.push_back(cube(random(0, 10), random(0, 10), 0, 0.01f));
    same_x.push_back(cube(1e3f, random(0, 2), random(0, 2), 0.01f));
  }
  Boxes reversed(line.rbegin(), line.rend());
  for (const Boxes* boxes : {&line, &reversed, &plane, &same_x}) {
    KdTree tree;
    tree.build(*boxes, everyone(count));
    CHECK(checked_depth(tree, count) <= std::uint32_t(2 * std::log2(double(count)) + 8));
  }
}

TEST_CASE("tree: the deepest codes stay within the bound") {
  // Distances that halve: every level splits one object off, on each of the three axes.
  Boxes boxes;
  for (int k = 0; k < 3; ++k)
    for (int power = 0; power < 24; ++power)
      for (int copy = 0; copy < 40; ++copy) {
        float at[3] = {0, 0, 0};
        at[k] = std::ldexp(1.0f, -power);
        boxes.push_back(cube(at[0], at[1], at[2], 1e-9f));
      }
  KdTree tree;
  tree.build(boxes, everyone(boxes.size()));
  CHECK(checked_depth(tree, boxes.size()) <= KdTree::max_depth);
  CHECK(pairs_of(tree) == brute_force(boxes));
}

TEST_CASE("tree: outliers do not flatten the rest") {
  const std::size_t count = 2000;
  Boxes boxes = cloud(count, 61, 10, 10, 10, 0.2f);
  KdTree tree;
  tree.build(boxes, everyone(count));
  const std::uint32_t before = checked_depth(tree, boxes.size());
  for (std::size_t i = 0; i < count; i += 200) boxes[i] = cube(1e20f, static_cast<float>(i), -1e25f, 1);
  tree.build(boxes, everyone(count));
  CHECK(checked_depth(tree, boxes.size()) <= before + 4);
  CHECK_FALSE(tree.wide_codes());
}

TEST_CASE("tree: NaN and inverted boxes are refused") {
  Boxes boxes = cloud(100, 71, 2, 2, 2, 0.5f);
  boxes[10].min[0] = not_a_number;
  boxes[20].max[2] = not_a_number;
  boxes[30] = {{1, 1, 1}, {0, 2, 2}};
  KdTree tree;
  tree.build(boxes, everyone(100));
  const std::vector<std::uint32_t> refused(tree.refused().begin(), tree.refused().end());
  CHECK(refused == std::vector<std::uint32_t>{10, 20, 30});
  CHECK(pairs_of(tree) == brute_force(boxes));
}

TEST_CASE("tree: billions of pairs are counted without listing them") {
  const Boxes boxes(100000, cube(0, 0, 0, 1));
  KdTree tree;
  tree.build(boxes, everyone(boxes.size()));
  CHECK(tree.count_pairs() == 100000ull * 99999 / 2);
}

TEST_CASE("boxes: rounding is outward") {
  for (const double x : {0.1, -0.1, 1e300, -1e300, 1.0, 0.0, 1e-60, -1e-60}) {
    CHECK(static_cast<double>(round_down(x)) <= x);
    CHECK(static_cast<double>(round_up(x)) >= x);
  }
  CHECK(round_down(1.0) == 1.0f);
  // to the neighbour, as std::nextafter has it
  CHECK(round_down(0.1) == std::nextafter(0.1f, -1.0f));
  CHECK(round_up(-0.1) == -round_down(0.1));
  CHECK(round_down(1e300) == std::numeric_limits<float>::max());
  CHECK(round_up(1e300) == std::numeric_limits<float>::infinity());
  CHECK(round_down(-1e-60) == -std::numeric_limits<float>::denorm_min());
  CHECK(std::isnan(round_up(static_cast<double>(not_a_number))));
  CHECK(contains(cube(0, 0, 0, 1), cube(0, 0, 0, 1)));
  for (int k = 0; k < 3; ++k) {
    Aabb box = cube(0, 0, 0, 0.5f);
    CHECK(contains(cube(0, 0, 0, 1), box));
    box.max[k] = 2;
    CHECK_FALSE(contains(cube(0, 0, 0, 1), box));
    box = cube(0, 0, 0, 0.5f);
    box.min[k] = -2;
    CHECK_FALSE(contains(cube(0, 0, 0, 1), box));
    box.min[k] = not_a_number;
    CHECK_FALSE(contains(cube(0, 0, 0, 1), box));
  }
}

TEST_CASE("boxes: they overlap when no axis separates them, and a NaN overlaps nothing") {
  for (int k = 0; k < 3; ++k)
    for (const float gap : {-0.5f, 0.0f, 0.5f}) {
      Aabb beside = cube(0, 0, 0, 1);
      beside.min[k] = 1 + gap;
      beside.max[k] = 3;
      CHECK(overlap(cube(0, 0, 0, 1), beside) == (gap <= 0));
      CHECK(overlap(beside, cube(0, 0, 0, 1)) == (gap <= 0));
      beside.min[k] = not_a_number;
      CHECK_FALSE(overlap(cube(0, 0, 0, 1), beside));
    }
}
