// The colouring's contract: it is that of sequential greedy in order of priority; no two constraints of a
// colour share a unit that moves; neither the order of input nor what happens elsewhere changes a colour.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "plan/coloring.h"

using namespace pcphys;

namespace {

constexpr std::uint32_t fixed_unit = Colouring::fixed_unit;

struct Graph {
  std::uint32_t unit_count = 0;
  std::vector<std::uint32_t> units, priorities;
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t kind = 0) {
    units.push_back(a), units.push_back(b);
    priorities.push_back(priority(std::min(a, b), std::max(a, b), kind));
  }
};

Graph random_graph(std::uint32_t unit_count, std::uint32_t constraints, float fixed_share, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  Graph graph{unit_count, {}, {}};
  for (std::uint32_t i = 0; i < constraints; ++i) {
    const auto a = static_cast<std::uint32_t>(engine() % unit_count),
               b = (a + 1 + static_cast<std::uint32_t>(engine() % (unit_count - 1))) % unit_count;
    graph.add(a, unit(engine) < fixed_share ? fixed_unit : b, i % 3);
  }
  return graph;
}

Colouring coloured(const Graph& graph) {
  Colouring colouring;
  colouring.build(graph.unit_count, graph.units, graph.priorities);
  return colouring;
}

// Word for word: the lowest colour free on both units; from 64 on the one after the last on either. Constraints with
// a fixed unit come after all others, above their colours.
std::vector<std::uint32_t> naive_greedy(const Graph& graph) {
  std::vector<std::uint32_t> order(graph.priorities.size()), colours(order.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return graph.priorities[i]; });
  const auto is_fixed = [&](std::uint32_t i) {
    return graph.units[2 * i] == fixed_unit || graph.units[2 * i + 1] == fixed_unit;
  };
  std::uint32_t first = 0;
  for (const bool with_fixed : {false, true}) {
    std::vector<std::set<std::uint32_t>> taken(graph.unit_count);
    std::uint32_t above = first;
    for (const std::uint32_t i : order) {
      if (is_fixed(i) != with_fixed) continue;
      const std::uint32_t ends[2] = {graph.units[2 * i], graph.units[2 * i + 1]};
      std::uint32_t colour = 0;
      const auto is_taken = [&](std::uint32_t end) { return end != fixed_unit && taken[end].contains(colour); };
      while (colour < 64 && (is_taken(ends[0]) || is_taken(ends[1]))) ++colour;
      if (colour == 64)
        for (const std::uint32_t end : ends)
          if (end != fixed_unit && !taken[end].empty()) colour = std::max(colour, *taken[end].rbegin() + 1);
      for (const std::uint32_t end : ends)
        if (end != fixed_unit) taken[end].insert(colour);
      colours[i] = first + colour;
      above = std::max(above, colours[i] + 1);
    }
    first = above;
  }
  return colours;
}

std::vector<std::uint32_t> copy(std::span<const std::uint32_t> values) { return {values.begin(), values.end()}; }

void check_valid(const Graph& graph, const Colouring& colouring) {
  std::vector<std::uint32_t> last(graph.unit_count, 0);  // colour + 1 that used the unit last
  std::vector<char> seen(graph.priorities.size(), 0);
  bool conflict = false, ascending = true, agrees = true;
  for (std::uint32_t c = 0; c < colouring.colours(); ++c) {
    const auto members = colouring.of_colour(c);
    CHECK_FALSE(members.empty());
    for (std::size_t n = 0; n < members.size(); ++n) {
      const std::uint32_t i = members[n];
      ascending &= n == 0 || members[n - 1] < i;
      agrees &= colouring.colour_of()[i] == c;
      seen[i] = 1;
      for (int side = 0; side < 2; ++side) {
        const std::uint32_t unit = graph.units[2 * i + side];
        if (unit == fixed_unit) continue;
        conflict |= last[unit] == c + 1;
        last[unit] = c + 1;
      }
    }
  }
  CHECK_FALSE(conflict);
  CHECK(ascending);
  CHECK(agrees);
  CHECK(std::ranges::count(seen, 1) == static_cast<std::ptrdiff_t>(seen.size()));
  CHECK(colouring.constraints() == seen.size());
}

}  // namespace

TEST_CASE("colouring: sequential greedy in order of priority, without conflicts") {
  for (const auto& [bodies, constraints, fixed_share] :
       std::vector<std::tuple<std::uint32_t, std::uint32_t, float>>{{2, 1, 0.0f},
                                                                    {2, 70, 0.0f},
                                                                    {10, 40, 0.3f},
                                                                    {1000, 4000, 0.2f},
                                                                    {50, 3000, 0.1f},
                                                                    {5000, 20000, 0.0f},
                                                                    {30, 500, 1.0f}}) {
    const Graph graph = random_graph(bodies, constraints, fixed_share, bodies + constraints);
    const Colouring colouring = coloured(graph);
    check_valid(graph, colouring);
    CHECK(copy(colouring.colour_of()) == naive_greedy(graph));
  }
}

TEST_CASE("colouring: nothing to colour, and after it something") {
  Colouring colouring;
  colouring.build(0, {}, {});
  CHECK(colouring.colours() == 0);
  const Graph graph = random_graph(20, 60, 0.2f, 4);
  colouring.build(graph.unit_count, graph.units, graph.priorities);
  CHECK(copy(colouring.colour_of()) == naive_greedy(graph));
  colouring.build(0, {}, {});
  CHECK(colouring.colours() == 0);
  CHECK(colouring.list().empty());
}

TEST_CASE("colouring: the order of input does not matter") {
  Graph graph = random_graph(400, 2000, 0.1f, 8);
  std::mt19937 engine(5);
  for (std::size_t i = 0; i < graph.priorities.size(); ++i)
    graph.priorities[i] = mixed(static_cast<std::uint32_t>(i));  // no two alike
  const Colouring straight = coloured(graph);
  std::vector<std::uint32_t> order(graph.priorities.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::shuffle(order, engine);
  Graph shuffled{graph.unit_count, {}, {}};
  for (const std::uint32_t i : order) {
    shuffled.units.push_back(graph.units[2 * i + 1]), shuffled.units.push_back(graph.units[2 * i]);
    shuffled.priorities.push_back(graph.priorities[i]);
  }
  const Colouring other = coloured(shuffled);
  bool same = true;
  for (std::size_t n = 0; n < order.size(); ++n) same &= other.colour_of()[n] == straight.colour_of()[order[n]];
  CHECK(same);
}

TEST_CASE("colouring: a hub of five thousand constraints") {
  Graph graph{5001, {}, {}};
  for (std::uint32_t i = 1; i <= 5000; ++i) graph.add(0, i);
  for (std::uint32_t i = 1; i < 5000; ++i) graph.add(i, i + 1);
  const Colouring colouring = coloured(graph);
  check_valid(graph, colouring);
  CHECK(colouring.colours() == 5000);
  CHECK(copy(colouring.colour_of()) == naive_greedy(graph));
}

TEST_CASE("colouring: fixed units never conflict") {
  Graph graph{1000, {}, {}};
  for (std::uint32_t i = 0; i < 1000; ++i) graph.add(i, fixed_unit);
  const Colouring colouring = coloured(graph);
  check_valid(graph, colouring);
  CHECK(colouring.colours() == 1);
  graph.add(fixed_unit, fixed_unit);
  CHECK(coloured(graph).colours() == 1);
}

TEST_CASE("colouring: a constraint far away changes no other colour") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Graph graph = random_graph(200, 900, 0.1f, seed);
    graph.unit_count = 203;
    const std::vector<std::uint32_t> before = copy(coloured(graph).colour_of());
    // in the middle of the list: the others' indices change, their priorities do not
    const std::uint32_t at = 450;
    graph.units.insert(graph.units.begin() + 2 * at, {200, 201});
    graph.priorities.insert(graph.priorities.begin() + at, priority(200, 201, 0));
    std::vector<std::uint32_t> after = copy(coloured(graph).colour_of());
    CHECK(after[at] == 0);
    after.erase(after.begin() + at);
    CHECK(after == before);
  }
}

TEST_CASE("colouring: priorities tell pairs apart") {
  std::vector<std::uint32_t> priorities;
  for (std::uint32_t a = 0; a < 300; ++a)
    for (std::uint32_t b = a + 1; b < 300; ++b) priorities.push_back(priority(a, b, 1));
  std::ranges::sort(priorities);
  const auto repeated = priorities.end() - std::unique(priorities.begin(), priorities.end());
  CHECK(repeated <= 2);  // 45,000 of 2^32: 0.2 expected
  CHECK(priority(1, 2, 0) != priority(1, 2, 1));
  std::vector<int> eighths(8, 0);
  for (const std::uint32_t p : priorities) ++eighths[p >> 29];
  for (const int count : eighths) CHECK(std::abs(count - static_cast<int>(priorities.size() / 8)) < 600);
}

TEST_CASE("colouring: slots are padded per colour, sides apart, padding is row 0") {
  const Graph graph = random_graph(100, 321, 0.2f, 3);
  const Colouring colouring = coloured(graph);
  std::vector<std::uint32_t> ends, rows;
  for (std::uint32_t i = 0; i < 321; ++i) {
    for (int side = 0; side < 2; ++side)
      ends.push_back(graph.units[2 * i + side] == fixed_unit ? 0 : graph.units[2 * i + side] + 1);
    rows.push_back(1000 + i);
  }
  for (const std::uint32_t width : {1u, 4u, 8u, 32u}) {
    CAPTURE(width);
    Slots slots;
    slots.order.assign(10000, 7);  // what was there before must not shine through
    slots.ends.assign(100, 7);
    pack_slots(colouring, width, ends, rows, slots);
    REQUIRE(slots.ranges.size() == colouring.colours());
    REQUIRE(slots.order.size() == slots.blocks() * width);
    REQUIRE(slots.ends.size() == slots.blocks() * width * 2);
    std::uint32_t block = 0;
    for (std::uint32_t c = 0; c < colouring.colours(); ++c) {
      CHECK(slots.ranges[c].begin == block);
      const auto members = colouring.of_colour(c);
      block += (static_cast<std::uint32_t>(members.size()) + width - 1) / width;
      CHECK(slots.ranges[c].end == block);
      bool right = true;
      for (std::uint32_t n = 0; n < (slots.ranges[c].end - slots.ranges[c].begin) * width; ++n) {
        const std::uint32_t at = slots.ranges[c].begin + n / width, lane = n % width;
        const bool filled = n < members.size();
        right &= slots.order[at * width + lane] == (filled ? rows[members[n]] : 0);
        for (std::uint32_t side = 0; side < 2; ++side)
          right &= slots.ends[(at * 2 + side) * width + lane] == (filled ? ends[2 * members[n] + side] : 0);
      }
      CHECK(right);
    }
  }
}
