// The pair cache's contract: whatever moves, comes and goes, every pair whose tight boxes overlap is listed,
// in order, and previous_index leads from each pair to what it was before; an overflow leaves all as it was.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "broad_support.h"
#include "collision/pair_cache.h"

using namespace broad_test;

namespace {

// A cache beside what it should know: per pair a number that must follow the pair until it breaks.
struct Watched {
  PairCache cache;
  std::vector<Aabb> tight;
  std::vector<char> here, moves;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> memory;  // of each listed pair
  std::vector<int> carried;
  int next = 0;

  std::uint32_t add(std::uint32_t proxy, const Aabb& box, bool mobile) {
    if (proxy >= tight.size())
      tight.resize(proxy + 1, cube(not_a_number, not_a_number, not_a_number, not_a_number)), here.resize(proxy + 1, 0),
          moves.resize(proxy + 1, 0);
    cache.add(proxy, mobile);
    tight[proxy] = box, here[proxy] = 1, moves[proxy] = mobile;
    forget(proxy);
    return proxy;
  }
  void remove(std::uint32_t proxy) {
    cache.remove(proxy);
    tight[proxy] = cube(not_a_number, 0, 0, 1), here[proxy] = 0;
    forget(proxy);
  }
  void forget(std::uint32_t proxy) {
    std::erase_if(memory, [&](const auto& entry) { return entry.first.first == proxy || entry.first.second == proxy; });
  }

  PairReport update() {
    const std::size_t before = cache.pairs().size();
    const PairReport report = cache.update(tight);
    REQUIRE_FALSE(report.overflow);
    check_memory(before, report);
    check_complete();
    return report;
  }

  void check_memory(std::size_t before, const PairReport& report) {
    const auto pairs = cache.pairs();
    const auto previous = cache.previous_index();
    REQUIRE(previous.size() == pairs.size());
    std::vector<int> now;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> listed;
    std::uint32_t added = 0;
    bool ordered = true, followed = true;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto [a, b] = pairs[i];
      ordered &= a < b && (i == 0 || std::pair(pairs[i - 1].a, pairs[i - 1].b) < std::pair(a, b));
      const auto known = memory.find({a, b});
      followed &= (previous[i] == PairCache::none) == (known == memory.end());
      if (previous[i] == PairCache::none) {
        now.push_back(next++);
        ++added;
      } else {
        REQUIRE(previous[i] < before);
        now.push_back(carried[previous[i]]);
        followed &= known != memory.end() && now.back() == known->second;
      }
      listed[{a, b}] = now.back();
    }
    CHECK(ordered);
    CHECK(followed);
    CHECK(report.added == added);
    CHECK(report.removed == before + added - pairs.size());
    carried = now;
    memory = listed;
  }

  // Nothing missing, and nothing that cannot be justified.
  void check_complete() const {
    std::size_t justified = 0;
    bool complete = true, exact = true;
    for (std::uint32_t a = 0; a < tight.size(); ++a) {
      for (std::uint32_t b = a + 1; b < tight.size(); ++b) {
        if (!here[a] || !here[b] || !valid(tight[a]) || !valid(tight[b]) || !(moves[a] || moves[b])) continue;
        const bool listed = memory.contains({a, b});
        complete &= listed || !overlap(tight[a], tight[b]);
        exact &= listed == overlap(cache.fat_box(a), cache.fat_box(b));
        justified += listed;
      }
    }
    CHECK(complete);
    CHECK(exact);
    CHECK(justified == memory.size());
  }
};

void shift(Aabb& box, float x, float y, float z) {
  box.min[0] += x, box.min[1] += y, box.min[2] += z;
  box.max[0] += x, box.max[1] += y, box.max[2] += z;
}

}  // namespace

TEST_CASE("pairs: none, one, two") {
  Watched w;
  CHECK_FALSE(w.update().changed);
  w.add(0, cube(0, 0, 0, 1), true);
  CHECK(w.update().changed);
  CHECK(w.cache.pairs().empty());
  w.add(5, cube(1, 0, 0, 1), true);
  CHECK(w.update().added == 1);
  CHECK(w.cache.pairs()[0] == Pair{0, 5});
  CHECK_FALSE(w.update().changed);
  w.remove(0);
  CHECK(w.update().removed == 1);
  w.remove(5);
  w.update();
  CHECK(w.cache.pairs().empty());
}

TEST_CASE("pairs: nothing is done while all stay in their fat boxes") {
  Watched w;
  for (std::uint32_t i = 0; i < 20; ++i) w.add(i, cube(0.9f * static_cast<float>(i), 0, 0, 0.5f), true);
  CHECK(w.update().moved == 20);
  for (Aabb& box : w.tight) shift(box, 0.02f, -0.01f, 0.03f);
  CHECK_FALSE(w.update().changed);
  shift(w.tight[7], 0.1f, 0, 0);
  const PairReport report = w.update();
  CHECK(report.changed);
  CHECK(report.moved == 1);
  CHECK_FALSE(report.rebuilt);
  CHECK(std::vector(w.cache.moved().begin(), w.cache.moved().end()) == std::vector<std::uint32_t>{7});
}

TEST_CASE("pairs: bodies that never move are not paired with each other") {
  Watched w;
  for (std::uint32_t i = 0; i < 50; ++i) w.add(i, cube(0, 0, 0, 1), i % 5 == 0);
  w.update();
  CHECK(w.cache.pairs().size() == 50 * 49 / 2 - 40 * 39 / 2);
  w.moves[3] = true;
  w.cache.set_moves(3, true);
  w.update();
  CHECK(w.cache.pairs().size() == 50 * 49 / 2 - 39 * 38 / 2);
  w.moves[0] = false;
  w.cache.set_moves(0, false);
  std::erase_if(w.memory, [&](const auto& e) { return !w.moves[e.first.first] && !w.moves[e.first.second]; });
  w.update();
  shift(w.tight[1], 0.5f, 0, 0);  // moved by hand
  w.update();
}

TEST_CASE("pairs: many steps of moving, coming, going and NaN") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Watched w;
    Random random(seed);
    const auto random_box = [&] { return cube(random(-4, 4), random(-4, 4), random(-4, 4), random(0.1f, 0.6f)); };
    for (std::uint32_t i = 0; i < 150; ++i) w.add(i, random_box(), random(0, 1) < 0.7f);
    w.add(150, {{-infinity, -infinity, -infinity}, {infinity, -3, infinity}}, false);
    w.add(151, {{-50, -5, -50}, {50, -2, 50}}, false);
    for (int step = 0; step < 120; ++step) {
      const float speed = step % 3 == 0 ? 0.5f : 0.02f;
      for (std::uint32_t i = 0; i < 150; ++i)
        if (w.here[i] && w.moves[i])
          shift(w.tight[i], random(-speed, speed), random(-speed, speed), random(-speed, speed));
      if (step % 4 == 1) {
        const std::uint32_t i = random.below(170);
        if (i < w.here.size() && w.here[i]) w.remove(i);
      }
      if (step % 4 != 2) {
        const std::uint32_t i = random.below(170);
        if (i >= w.here.size() || !w.here[i]) w.add(i, random_box(), random(0, 1) < 0.7f);
      }
      if (step % 10 == 5) {  // replaced within one step
        const std::uint32_t i = random.below(150);
        if (w.here[i]) {
          const Aabb box = w.tight[i];
          w.remove(i);
          w.add(i, box, true);
        }
      }
      if (step % 7 == 3) {
        const std::uint32_t i = random.below(150);
        if (w.here[i]) {
          const Aabb good = w.tight[i];
          w.tight[i].max[1] = not_a_number;
          const PairReport report = w.update();
          CHECK(report.refused == 1);
          CHECK(report.first_refused == i);
          CHECK(w.update().refused == 1);
          w.tight[i] = good;
        }
      }
      const PairReport report = w.update();
      CHECK(report.refused == 0);
      if (random(0, 1) < 0.2f) CHECK_FALSE(w.update().changed);
    }
  }
}

TEST_CASE("pairs: the order is the same whatever happened before") {
  Random random(9);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 500; ++i) boxes.push_back(cube(random(-5, 5), random(-5, 5), random(-5, 5), 0.4f));
  PairCache straight, winding;
  for (PairCache* cache : {&straight, &winding}) {
    cache->set_margin(0, 0);  // no fat, no history in the set
    for (std::uint32_t i = 0; i < boxes.size(); ++i) cache->add(i, true);
  }
  for (int step = 0; step < 5; ++step) {
    std::vector<Aabb> elsewhere = boxes;
    for (Aabb& box : elsewhere) shift(box, random(-1, 1), random(-1, 1), random(-1, 1));
    winding.update(elsewhere);
  }
  straight.update(boxes);
  winding.update(boxes);
  REQUIRE(straight.pairs().size() == winding.pairs().size());
  CHECK(std::equal(straight.pairs().begin(), straight.pairs().end(), winding.pairs().begin()));
}

TEST_CASE("pairs: the filter, and touch when it changes its mind") {
  struct Rule {
    std::uint32_t forbidden;
  } rule{1000};
  Watched w;
  w.cache.set_filter(
      [](const void* context, std::uint32_t a, std::uint32_t b) {
        const std::uint32_t forbidden = static_cast<const Rule*>(context)->forbidden;
        return a != forbidden && b != forbidden;
      },
      &rule);
  for (std::uint32_t i = 0; i < 10; ++i) w.add(i, cube(0, 0, 0, 1), true);
  w.update();
  CHECK(w.cache.pairs().size() == 45);
  rule.forbidden = 4;
  w.cache.touch(4);
  CHECK(w.cache.update(w.tight).removed == 9);
  CHECK(w.cache.pairs().size() == 36);
  CHECK(std::ranges::all_of(w.cache.previous_index(), [](std::uint32_t i) { return i < 45; }));
  rule.forbidden = 1000;
  w.cache.touch(4);
  const PairReport report = w.cache.update(w.tight);
  CHECK(report.added == 9);
  CHECK(report.removed == 0);
}

TEST_CASE("pairs: capacity exactly, and one over") {
  Watched w;
  for (std::uint32_t i = 0; i < 40; ++i) w.add(i, cube(0, 0, 0, 1), true);
  w.cache.set_capacity(40 * 39 / 2);
  w.update();
  const std::vector<Pair> full(w.cache.pairs().begin(), w.cache.pairs().end());
  REQUIRE(full.size() == 780);

  w.tight.push_back(cube(2.04f, 0, 0, 1));  // overlaps the fat boxes of all
  w.cache.add(40, true);
  shift(w.tight[0], 10, 0, 0);
  shift(w.tight[0], -9, 0, 0);
  for (int again = 0; again < 2; ++again) {
    const PairReport report = w.cache.update(w.tight);
    CHECK(report.overflow);
    CHECK(report.pairs_needed == 820);
    CHECK(report.needed_is_exact);
    CHECK_FALSE(report.changed);
    REQUIRE(w.cache.pairs().size() == 780);
    CHECK(std::equal(full.begin(), full.end(), w.cache.pairs().begin()));
    bool identity = true;
    for (std::uint32_t i = 0; i < 780; ++i) identity &= w.cache.previous_index()[i] == i;
    CHECK(identity);
  }
  w.cache.set_capacity(819);
  CHECK(w.cache.update(w.tight).overflow);
  w.cache.set_capacity(820);
  w.here.push_back(1), w.moves.push_back(1);
  const PairReport report = w.update();
  CHECK(report.added == 40);
  CHECK(report.removed == 0);
  w.cache.set_capacity(0);
  CHECK_FALSE(w.cache.update(w.tight).overflow);  // nothing moved: nothing is asked
  w.remove(40);
  CHECK(w.cache.update(w.tight).pairs_needed == 780);
}

TEST_CASE("pairs: one hundred thousand coincident boxes overflow at once, with the number") {
  const std::uint32_t count = 100000;
  const std::vector<Aabb> tight(count, cube(1, 2, 3, 0.5f));
  PairCache cache;
  cache.set_capacity(1000);
  for (std::uint32_t i = 0; i < count; ++i) cache.add(i, true);
  PairReport report = cache.update(tight);
  CHECK(report.overflow);
  CHECK(report.pairs_needed == std::uint64_t{count} * (count - 1) / 2);
  CHECK(report.needed_is_exact);
  cache.set_filter([](const void*, std::uint32_t a, std::uint32_t b) { return (a + b) % 3 != 0; }, nullptr);
  report = cache.update(tight);
  CHECK(report.overflow);
  CHECK_FALSE(report.needed_is_exact);
  CHECK(report.pairs_needed == std::uint64_t{count} * (count - 1) / 2);
}
